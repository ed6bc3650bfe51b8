// Places a corner of a box. Of each instance only the three faces towards the eye are made, six corners each.

layout(std430, binding = 1) readonly buffer Voxels { uvec4 voxels[]; }; // centre as floats [m], colour in 3 x 8 bits

layout(location = 0) uniform mat4 viewProjection;
layout(location = 1) uniform vec3 edge;       // [m]
layout(location = 2) uniform uint colored;    // 0: by the faces' normals
layout(location = 3) uniform vec4 eye;        // point; w 0: the direction towards it

out vec3 fragPosition;
flat out vec3 fragNormal;
flat out vec3 fragColor;

void main() {
    vec3 centre = uintBitsToFloat(voxels[gl_InstanceID].xyz);
    uint bits = voxels[gl_InstanceID].w;
    int axis = gl_VertexID / 6, corner = gl_VertexID % 6;
    vec3 towards = eye.xyz - eye.w * centre;
    vec3 normal = vec3(0.0), u = vec3(0.0), v = vec3(0.0);
    normal[axis] = towards[axis] < 0.0 ? -1.0 : 1.0;
    u[(axis + 1) % 3] = normal[axis];
    v[(axis + 2) % 3] = 1.0;
    float s = corner == 1 || corner == 2 || corner == 4 ? 1.0 : -1.0;
    float t = corner == 2 || corner == 4 || corner == 5 ? 1.0 : -1.0;
    fragPosition = centre + 0.5 * edge * (normal + s * u + t * v);
    fragNormal = normal;
    vec3 own = vec3(bits & 255u, (bits >> 8) & 255u, (bits >> 16) & 255u) / 255.0;
    fragColor = colored != 0u ? own : 0.5 * normal + 0.5;
    gl_Position = viewProjection * vec4(fragPosition, 1.0);
}
