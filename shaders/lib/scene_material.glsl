// C++ and the OpenGL shaders of a scene share this. It is legal as GLSL and as C++ (namespace
// relume::shader).

// The views say what is drawn of a scene.
CONST uint kViewLit = 0u;       // emission + albedo x lighting
CONST uint kViewLighting = 1u;  // the lightmap
CONST uint kViewAlbedo = 2u;
CONST uint kViewEmission = 3u;
CONST uint kViewNormal = 4u;    // shading normal, world space
CONST uint kViewMaterial = 5u;  // a colour for each
CONST uint kViewInstance = 6u;
CONST uint kViewChecker = 7u;   // lightmap texels as a checker, tiles of 8 x 8 tinted
CONST uint kViewDensity = 8u;   // lightmap texels per metre against the scene's median
CONST uint kViewCoverage = 9u;  // of the lightmap: patches, filled texels, empty ones
// These views show a quantity that the baker put in the lightmap's place.
CONST uint kViewInspectColor = 10u;    // light
CONST uint kViewInspectRaw = 11u;      // RGB as displayed
CONST uint kViewInspectPosition = 12u; // as a share of a range
CONST uint kViewInspectNormal = 13u;
CONST uint kViewInspectHeat = 14u;     // R on a scale of colours
CONST uint kViewInspectLeaves = 15u;   // R log2 of the edge [texels], G 1 along the border, B tells leaves apart
CONST uint kViewInspectMask = 16u;     // R 1 seen, 0 not; G form factor over the largest; B 1: seen from here
CONST uint kViewCount = 17u;

CONST uint kFilterNearest = 0u;
CONST uint kFilterBilinear = 1u;
CONST uint kFilterBicubic = 2u;

// MAPPED says of a draw's triangles whether they have lightmap UVs.
CONST uint kMappedNone = 0u;
CONST uint kMappedSome = 1u;
CONST uint kMappedAll = 2u;

CONST uint kTileTexels = 8u;       // along each side of a tile, the unit of the baker's order
CONST uint kNoUv = 0xffffffffu;    // in place of a coordinate's bits

// The layout is std430, so it has vectors of four only.
struct SceneMaterial {
    vec4 baseColor;  // linear
    vec4 emission;   // rgb [cd/m^2]; a: alpha below it is cut out, 0 for none
    vec4 metallic;   // x metallic, y roughness; of a pane: z transmission, w 1 where alpha counts
};

// Returns the share of light that comes back from a surface: a rough metal sends some on, as the baker has
// it.
FUNCTION vec3 diffuseAlbedo(vec3 baseColor, float metallic, float roughness) {
    return baseColor * (1.0f - metallic + 0.5f * metallic * roughness * roughness);
}
