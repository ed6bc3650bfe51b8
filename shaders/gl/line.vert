// Places a vertex of a line, in world space.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 color;

layout(location = 0) uniform mat4 viewProjection;

out vec3 fragColor;

void main() {
    fragColor = color;
    gl_Position = viewProjection * vec4(position, 1.0);
    // The line is moved towards the eye by a share of the distance: lines lie on surfaces, and depth grows
    // towards the eye.
    gl_Position.z += 2e-4 * gl_Position.z;
}
