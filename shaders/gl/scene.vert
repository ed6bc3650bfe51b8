// Places a vertex of the scene, in world space as it was loaded.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 baseUv;
layout(location = 3) in vec2 emissionUv;
layout(location = 4) in vec2 metallicUv;
layout(location = 5) in vec2 lightmapUv;
layout(location = 6) in vec4 color;
layout(location = 7) in uvec2 ids; // instance; 1 where there are lightmap UVs

layout(location = 0) uniform mat4 viewProjection;
layout(location = 13) uniform mat4 placement; // from where its instance was loaded to where it stands
layout(location = 14) uniform mat3 turning;   // the same of normals, of any length

out vec3 fragPosition;
out vec3 fragNormal;
out vec2 fragBaseUv;
out vec2 fragEmissionUv;
out vec2 fragMetallicUv;
out vec2 fragLightmapUv;
out vec4 fragColor;
flat out uvec2 fragIds;

void main() {
    vec4 placed = placement * vec4(position, 1.0);
    fragPosition = placed.xyz;
    fragNormal = turning * normal;
    fragBaseUv = baseUv;
    fragEmissionUv = emissionUv;
    fragMetallicUv = metallicUv;
    fragLightmapUv = lightmapUv;
    fragColor = color;
    fragIds = ids;
    gl_Position = viewProjection * placed;
}
