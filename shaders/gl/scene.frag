// Shades a fragment of the scene in view VIEW with lightmap filter FILTER and tone mapping TONE. What a
// material does not need is not fetched: BASE, EMISSION, METALLIC say which textures it has, MASKED whether
// it has holes, MAPPED whether there are lightmap UVs; SELECTED tints; PANE says that what is behind shows.

#include "lib/scene_material.glsl"
#include "gl/light.glsl"
#include "gl/lightmap.glsl"
#include "gl/inspect.glsl"

layout(binding = 0) uniform sampler2D baseTexture;
layout(binding = 1) uniform sampler2D emissionTexture;
layout(binding = 2) uniform sampler2D metallicTexture;
layout(std430, binding = 0) readonly buffer Materials { SceneMaterial materials[]; };

layout(location = 1) uniform uint material;
layout(location = 4) uniform vec3 eye;
layout(location = 5) uniform vec3 ambient;        // lighting where there is no lightmap [cd/m^2]
layout(location = 6) uniform uint lightmapSize;   // [texels]
layout(location = 8) uniform float medianDensity; // of the scene, in texels per metre at lightmapSize
layout(location = 10) uniform float unit;         // of the lightmap's light [cd/m^2]

in vec3 fragPosition;
in vec3 fragNormal;
in vec2 fragBaseUv;
in vec2 fragEmissionUv;
in vec2 fragMetallicUv;
in vec2 fragLightmapUv;
in vec4 fragColor;
flat in uvec2 fragIds;

out vec4 result; // as displayed; a: for the meter, of a pane its opacity

// These are constants, not uniforms: a software device would go through all branches.
const uint view = VIEW;
const uint filterKind = FILTER;
const vec3 kNoLightmap = vec3(0.35, 0.3, 0.4); // display; of geometry without lightmap UVs
const vec3 kSelected = vec3(1.0, 0.55, 0.1);   // display

bool mapped() {
    return MAPPED == kMappedAll || (MAPPED == kMappedSome && fragIds.y != 0u);
}

// Returns light from the viewer's side, so that shapes show where there is no other light.
float headlight() {
    return 0.6 + 0.4 * abs(dot(normalize(fragNormal), normalize(eye - fragPosition)));
}

vec3 lighting() {
    if (MAPPED == kMappedNone) return ambient * headlight();
    if (MAPPED == kMappedAll) return unit * sampleLightmap(fragLightmapUv, filterKind, ambient / unit);
    vec3 flatLight = ambient * headlight();
    return mapped() ? unit * sampleLightmap(fragLightmapUv, filterKind, flatLight / unit) : flatLight;
}

vec4 baseColor(SceneMaterial m) {
    vec4 base = m.baseColor * fragColor;
    return BASE != 0 ? base * texture(baseTexture, fragBaseUv) : base;
}

vec3 albedo(SceneMaterial m, vec3 base) {
    vec2 metal = METALLIC != 0 ? texture(metallicTexture, fragMetallicUv).bg : vec2(1.0);
    return diffuseAlbedo(base, m.metallic.x * metal.x, m.metallic.y * metal.y);
}

vec3 emission(SceneMaterial m) {
    return EMISSION != 0 ? m.emission.rgb * texture(emissionTexture, fragEmissionUv).rgb : m.emission.rgb;
}

// Returns how much of a pane is seen; glass that lets all pass shows a little all the same.
float opacity(SceneMaterial m, float alpha) {
    const float kLeast = 0.08;
    return clamp((m.metallic.w != 0.0 ? alpha : 1.0) * (1.0 - m.metallic.z), kLeast, 1.0);
}

// Returns hues a golden angle apart: neighbours in number are far apart in colour.
vec3 idColor(uint id) {
    float hue = fract(float(id) * 0.61803399 + 0.13);
    vec3 rgb = clamp(abs(fract(hue + vec3(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
    float value = 0.95 - 0.25 * fract(float(id) * 0.381966);
    return value * mix(vec3(1.0), rgb, 0.55);
}

vec3 checkerColor() {
    vec2 texel = floor(fragLightmapUv * float(lightmapSize));
    vec2 tile = floor(texel / float(kTileTexels));
    float odd = mod(texel.x + texel.y, 2.0), oddTile = mod(tile.x + tile.y, 2.0);
    vec3 tint = mix(vec3(1.0, 0.93, 0.8), vec3(0.78, 0.88, 1.0), oddTile);
    return tint * mix(0.55, 0.9, odd);
}

// Returns blue for fewer texels per metre than the median, red for more; full colour at a factor of 4.
vec3 densityColor(vec2 tx, vec2 ty, vec3 px, vec3 py) {
    float texels = float(lightmapSize) * sqrt(abs(tx.x * ty.y - tx.y * ty.x));
    float metres = sqrt(length(cross(px, py)));
    float density = texels / max(metres, 1e-30);
    float octaves = clamp(log2(max(density / medianDensity, 1e-6)) / 2.0, -1.0, 1.0);
    vec3 end = octaves < 0.0 ? vec3(0.15, 0.3, 0.85) : vec3(0.85, 0.2, 0.1);
    return mix(vec3(0.9), end, abs(octaves));
}

vec3 coverageColor() {
    float coverage = texelFetch(lightmap, ivec2(fragLightmapUv * float(lightmapSize)), 0).a;
    return coverage > 0.75  ? vec3(0.35, 0.7, 0.4)  // a patch
           : coverage > 0.0 ? vec3(0.95, 0.75, 0.2) // filled from its neighbours
                            : vec3(0.85, 0.15, 0.15);
}

vec3 inspectColor() {
    vec3 none = view == kViewInspectHeat ? rangeLow : vec3(0.0);
    return quantityColor(sampleLightmap(fragLightmapUv, filterKind, none));
}

vec4 shown(SceneMaterial m, vec3 base) {
    // Derivatives need all fragments of a quad: none stands in a branch.
    vec3 px = dFdx(fragPosition), py = dFdy(fragPosition);
    vec2 tx = dFdx(fragLightmapUv), ty = dFdy(fragLightmapUv);
    switch (view) {
    case kViewLit: return displayedLight(emission(m) + albedo(m, base) * lighting());
    case kViewLighting: return displayedLight(lighting());
    case kViewEmission: return displayedLight(emission(m));
    case kViewAlbedo: return vec4(srgbEncode(clamp(albedo(m, base), 0.0, 1.0)), 1.0);
    case kViewNormal: return vec4(0.5 * normalize(fragNormal) + 0.5, 1.0);
    case kViewMaterial: return vec4(idColor(material) * headlight(), 1.0);
    case kViewInstance: return vec4(idColor(fragIds.x) * headlight(), 1.0);
    default: break;
    }
    if (!mapped()) return vec4(kNoLightmap * headlight(), 1.0);
    switch (view) {
    case kViewChecker: return vec4(checkerColor() * headlight(), 1.0);
    case kViewDensity: return vec4(densityColor(tx, ty, px, py) * headlight(), 1.0);
    case kViewCoverage: return vec4(coverageColor() * headlight(), 1.0);
    case kViewInspectColor: return displayedLight(unit * sampleLightmap(fragLightmapUv, filterKind, vec3(0.0)));
    default: return vec4(inspectColor(), 1.0);
    }
}

void main() {
    SceneMaterial m = materials[material];
    vec4 base = baseColor(m);
    vec4 color = shown(m, base.rgb);
    if (SELECTED != 0) color.rgb = mix(color.rgb, kSelected, 0.35);
    if (MASKED != 0 && base.a < m.emission.a) discard; // behind all look-ups: mips need whole quads
    result = PANE != 0 ? vec4(color.rgb, opacity(m, base.a)) : color;
}
