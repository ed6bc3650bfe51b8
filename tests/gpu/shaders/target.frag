#version 460
#extension GL_EXT_nonuniform_qualifier : require
layout(set = 0, binding = 0) uniform sampler2D textures[];
layout(push_constant) uniform Push {
    float value;
    uint texture;
} push;
layout(location = 0) in vec2 position;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
    first = vec4(push.value, texture(textures[nonuniformEXT(push.texture)], vec2(0.5)).x, 0.0, 1.0);
    second = textureLod(textures[nonuniformEXT(push.texture)], vec2(0.25), 1.0);
}
