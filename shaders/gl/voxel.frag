// Draws a box's face, brighter towards the viewer so that edges show.

layout(location = 3) uniform vec4 eye; // point; w 0: the direction towards it

in vec3 fragPosition;
flat in vec3 fragNormal;
flat in vec3 fragColor;

out vec4 result;

void main() {
    vec3 towards = normalize(eye.xyz - eye.w * fragPosition);
    result = vec4(fragColor * (0.55 + 0.45 * abs(dot(fragNormal, towards))), 1.0);
}
