// Draws a line's colour as displayed.

layout(location = 1) uniform float opacity;

in vec3 fragColor;

out vec4 result;

void main() {
    result = vec4(fragColor, opacity);
}
