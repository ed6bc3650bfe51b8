// One triangle over the left half of the target and more.
#version 460
layout(location = 0) out vec2 position;
void main() {
    vec2 corners[3] = vec2[](vec2(-1.0, -1.0), vec2(0.0, -1.0), vec2(-1.0, 1.0));
    position = corners[gl_VertexIndex];
    gl_Position = vec4(position, 0.0, 1.0);
}
