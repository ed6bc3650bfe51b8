// Places a corner of the square in which a ball is seen: two triangles that face the eye.

struct Ball {
    vec4 place;       // [m]; w: radius
    vec4 lighting[9]; // ball.frag; the first one's w: kind
};
layout(std430, binding = 1) readonly buffer Balls { Ball balls[]; };

layout(location = 0) uniform mat4 viewProjection;
layout(location = 3) uniform vec4 eye; // point; w 0: the direction towards it

out vec3 fragPoint; // on the square
flat out int fragBall;

void main() {
    vec3 centre = balls[gl_InstanceID].place.xyz;
    float radius = balls[gl_InstanceID].place.w;
    vec3 way = eye.xyz - eye.w * centre;
    float far2 = dot(way, way);
    vec3 towards = way * inversesqrt(max(far2, 1e-20));
    // A ball that is near is seen wider than its great circle: along the cone that touches it.
    float wide = eye.w == 0.0 ? 1.0 : sqrt(far2 / max(far2 - radius * radius, 1e-4 * far2));
    vec3 side = normalize(cross(abs(towards.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), towards));
    vec3 above = cross(towards, side);
    int corner = gl_VertexID;
    float s = corner == 1 || corner == 2 || corner == 4 ? 1.0 : -1.0;
    float t = corner == 2 || corner == 4 || corner == 5 ? 1.0 : -1.0;
    fragPoint = centre + wide * radius * (s * side + t * above);
    fragBall = gl_InstanceID;
    gl_Position = viewProjection * vec4(fragPoint, 1.0);
}
