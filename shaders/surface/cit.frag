// CIT pass: finds the surface behind a texel's centre. Masks are looked at later (bake/surface/masked_texels.h).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_nonuniform_qualifier : require
#include "lib/preamble.glsl"
layout(push_constant, scalar) uniform Push { CitPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CitMaterials { CitMaterial items[]; };
layout(set = 0, binding = 0) uniform sampler2D textures[];

layout(location = 0) in vec3 bary;
layout(location = 1) in vec2 pixel;
layout(location = 2) flat in uint triangle;
layout(location = 3) flat in uint grown;
layout(location = 4) flat in vec4 pixelBounds;

layout(location = 0) out vec4 outPosition; // [m], a = 1: a patch
layout(location = 1) out vec4 outNormal;   // unit, shading
layout(location = 2) out vec4 outAlbedo;
layout(location = 3) out vec4 outEmission; // [cd/m^2]
layout(location = 4) out uint outTriangle; // 1 + index

vec2 uvAt(ADDRESS uvs, vec3 b) {
    uint i = triangle * 3u;
    Vec2s list = Vec2s(uvs);
    return list.items[i] * b.x + list.items[i + 1u] * b.y + list.items[i + 2u] * b.z;
}

vec4 texel(int index, vec2 uv, vec2 dx, vec2 dy) {
    if (index < 0) return vec4(1.0);
    return textureGrad(textures[nonuniformEXT(index)], uv, dx, dy);
}

// Moves a point on the triangle's edge a quarter of a texel towards its centre: on the very edge it would lie
// in the neighbouring wall and see nothing.
vec3 inwards(vec3 b) {
    const float kInset = 0.25; // texels
    float away = length(uvAt(push.lightmapUv, vec3(1.0 / 3.0)) - uvAt(push.lightmapUv, b)) * float(push.size);
    return mix(b, vec3(1.0 / 3.0), min(1.0, kInset / max(away, 1e-6)));
}

void main() {
    if (grown != 0u) {
        // The grown triangle's tips reach beyond the texels it touches.
        if (any(lessThan(pixel, pixelBounds.xy - 0.5)) || any(greaterThan(pixel, pixelBounds.zw + 0.5))) discard;
    }
    // Interpolated one by one, the weights of a small or thin triangle sum to 1 only within 1e-5: for a far
    // coordinate that is more than a patch's offset, and the point leaves the triangle's plane.
    vec3 b = vec3(1.0 - bary.y - bary.z, bary.yz);
    vec3 dx = dFdx(b), dy = dFdy(b);
    if (grown != 0u) {
        // A centre outside the triangle stands for the nearest surface, never for the air beside it.
        b = max(b, vec3(0.0));
        b = inwards(b / (b.x + b.y + b.z));
    }
    uint i = triangle * 3u;
    Vec3s positions = Vec3s(push.positions), normals = Vec3s(push.normals);
    Vec4s colors = Vec4s(push.colors);
    vec3 normal = normals.items[i] * b.x + normals.items[i + 1u] * b.y + normals.items[i + 2u] * b.z;
    vec4 color = colors.items[i] * b.x + colors.items[i + 1u] * b.y + colors.items[i + 2u] * b.z;

    CitMaterial m = CitMaterials(push.materials).items[Words(push.material).items[triangle]];
    bool rtrad = push.rtrad != 0u; // it knows neither vertex colours nor emission textures
    if (rtrad) color = vec4(1.0);
    vec4 base = m.baseColor * color * texel(m.baseTexture, uvAt(push.baseUv, b), uvAt(push.baseUv, dx), uvAt(push.baseUv, dy));
    vec3 emission = m.emission * texel(rtrad ? -1 : m.emissionTexture, uvAt(push.emissionUv, b), uvAt(push.emissionUv, dx),
                                       uvAt(push.emissionUv, dy)).rgb;
    vec4 surface = texel(m.metallicTexture, uvAt(push.metallicUv, b), uvAt(push.metallicUv, dx), uvAt(push.metallicUv, dy));
    float metallic = m.metallic * surface.b, roughness = m.roughness * surface.g;
    // A rough metal still sends light on, as Unity's meta pass has it.
    float diffuse = rtrad ? 1.0 : 1.0 - metallic + 0.5 * metallic * roughness * roughness;

    vec3 corner = positions.items[i];
    vec3 along = (positions.items[i + 1u] - corner) * b.y + (positions.items[i + 2u] - corner) * b.z;
    outPosition = vec4(corner + along, 1.0);
    float size = length(normal);
    outNormal = vec4(size > 0.0 ? normal / size : vec3(0.0), 0.0);
    outAlbedo = vec4(base.rgb * diffuse, base.a);
    outEmission = vec4(emission, 1.0);
    outTriangle = triangle + 1u;
}
