// The shaders. The picture is that of the program's shaders/gl/scene.frag; what both share is put in from shaders/lib.
'use strict';
relume.shaders = (function () {
    const shared = `
#define FUNCTION
#define CONST const
precision highp float;
precision highp int;
precision highp sampler2D;
@lib/tone.glsl@
@lib/scene_material.glsl@
@lib/light/sky_place.glsl@
uniform float meterScale; // brings the scene's light near 1, whatever its unit
uniform float exposure;   // factor
// Returns light as displayed; a: how bright it is, for the meter. Both are dithered and rounded, as the program does it.
vec4 displayedLight(vec3 light) {
    float noise = 0.998 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.499;
    float code = meterCode(luminance(light) * meterScale);
    vec3 steps = 255.0 * toneMapAsSrgb(light * exposure, kToneAgx) + noise;
    return floor(vec4(steps, code > 0.0 ? code + noise : 0.0) + 0.5) / 255.0;
}
`;
    const screenVertex = `
uniform float depth;
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, depth, 1.0);
}
`;
    // Sums up to 64 layers, weights[i].rgb times layer weights[i].a, and the rest, restScale times another lightmap.
    const mixFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
uniform sampler2DArray layers;
uniform sampler2D coverage;
uniform int count;
uniform vec4 weights[64];
uniform float share; // of the coverage: 1 in the first pass, 0 in those that add to it
#if REST
uniform sampler2D rest;
uniform float restScale;
#endif
out vec4 result;
void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 sum = vec3(0.0);
#if REST
    sum = restScale * texelFetch(rest, texel, 0).rgb;
#endif
    for (int i = 0; i < count; ++i)
        sum += weights[i].rgb * texelFetch(layers, ivec3(texel, int(weights[i].a)), 0).rgb;
    result = vec4(sum, share * texelFetch(coverage, texel, 0).r);
}
`;
    const sceneVertex = `
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 baseUv;
layout(location = 3) in vec2 emissionUv;
layout(location = 4) in vec2 metallicUv;
layout(location = 5) in vec2 lightmapUv;
layout(location = 6) in vec4 color;
layout(location = 7) in float mapped;
uniform mat4 viewProjection;
out vec3 fragPosition;
out vec3 fragNormal;
out vec2 fragBaseUv;
out vec2 fragEmissionUv;
out vec2 fragMetallicUv;
out vec2 fragLightmapUv;
out vec4 fragColor;
flat out float fragMapped;
void main() {
    fragPosition = position;
    fragNormal = normal;
    fragBaseUv = baseUv;
    fragEmissionUv = emissionUv;
    fragMetallicUv = metallicUv;
    fragLightmapUv = lightmapUv;
    fragColor = color;
    fragMapped = mapped;
    gl_Position = viewProjection * vec4(position, 1.0);
}
`;
    // BASE, EMISSION and METALLIC say which textures there are, MASKED whether there are holes, MAPPED which triangles have
    // lightmap UVs, FILLED that no texel which a filter reaches is empty, PANE that what is behind shows.
    const sceneFragment = shared + `
uniform sampler2D baseTexture;
uniform sampler2D emissionTexture;
uniform sampler2D metallicTexture;
uniform sampler2D lightmap;
uniform vec4 baseColor;
uniform vec3 emission;   // [cd/m^2]
uniform float cutoff;
uniform vec4 surface;    // metallic, roughness; of a pane: transmission, 1 where alpha counts
uniform vec3 eye;
uniform vec3 ambient;    // lighting where there is no lightmap [cd/m^2]
uniform float unit;      // of the lightmap's light [cd/m^2]
in vec3 fragPosition;
in vec3 fragNormal;
in vec2 fragBaseUv;
in vec2 fragEmissionUv;
in vec2 fragMetallicUv;
in vec2 fragLightmapUv;
in vec4 fragColor;
flat in float fragMapped;
out vec4 result;

float filledAt(ivec2 texel, ivec2 size) {
    return texelFetch(lightmap, clamp(texel, ivec2(0), size - 1), 0).a > 0.0 ? 1.0 : 0.0;
}
// Returns the lightmap at uv; empty texels are left out, and where all are empty it is what there is otherwise.
vec3 sampleLightmap(vec2 uv, vec3 otherwise) {
    vec3 light = textureLod(lightmap, uv, 0.0).rgb;
#if FILLED
    return light;
#else
    ivec2 size = textureSize(lightmap, 0);
    vec2 place = uv * vec2(size) - 0.5;
    ivec2 first = ivec2(floor(place));
    vec2 f = place - vec2(first);
    float filled = mix(mix(filledAt(first, size), filledAt(first + ivec2(1, 0), size), f.x),
                       mix(filledAt(first + ivec2(0, 1), size), filledAt(first + ivec2(1, 1), size), f.x), f.y);
    return filled > 1e-4 ? light / filled : otherwise;
#endif
}
float headlight() {
    return 0.6 + 0.4 * abs(dot(normalize(fragNormal), normalize(eye - fragPosition)));
}
vec3 lighting() {
#if MAPPED == 2
    return unit * sampleLightmap(fragLightmapUv, ambient / unit);
#else
    vec3 flatLight = ambient * headlight();
    return MAPPED == 1 && fragMapped > 0.5 ? unit * sampleLightmap(fragLightmapUv, flatLight / unit) : flatLight;
#endif
}
void main() {
    vec4 base = baseColor * fragColor;
    vec2 metal = vec2(1.0);
    vec3 shine = emission;
#if BASE
    base *= texture(baseTexture, fragBaseUv);
#endif
#if METALLIC
    metal = texture(metallicTexture, fragMetallicUv).bg;
#endif
#if EMISSION
    shine *= texture(emissionTexture, fragEmissionUv).rgb;
#endif
    vec3 albedo = diffuseAlbedo(base.rgb, surface.x * metal.x, surface.y * metal.y);
    vec4 color = displayedLight(shine + albedo * lighting());
#if MASKED
    if (base.a < cutoff) discard;
#endif
#if PANE
    color.a = clamp((surface.w != 0.0 ? base.a : 1.0) * (1.0 - surface.z), 0.08, 1.0);
#endif
    result = color;
}
`;
    const skyFragment = shared + `
uniform sampler2D picture;
uniform vec3 ahead;
uniform vec3 across;
uniform vec3 above;
uniform vec2 size;
uniform vec3 radiance;
uniform float rotation;
out vec4 result;
void main() {
    vec2 place = 2.0 * gl_FragCoord.xy / size - 1.0;
    vec3 direction = normalize(ahead + place.x * across + place.y * above);
    vec3 light = radiance;
#if PICTURE
    light *= textureLod(picture, skyPlace(direction, rotation), 0.0).rgb;
#endif
    result = vec4(displayedLight(light).rgb, 0.0);
}
`;
    const showFragment = `
precision highp float;
uniform sampler2D picture;
uniform vec2 size;
out vec4 result;
void main() {
    result = vec4(texture(picture, gl_FragCoord.xy / size).rgb, 1.0);
}
`;
    return { screenVertex, mixFragment, sceneVertex, sceneFragment, skyFragment, showFragment };
})();
