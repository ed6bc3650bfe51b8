#pragma once

#include "tests/unit/glb_builder.h"
#include "tests/unit/webp_pictures.h"

namespace relume::test {

inline void useImage(GlbBuilder& b, const nlohmann::json& image) {
    b.json["images"] = nlohmann::json::array({image});
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
}

/// Makes a scene that uses most of what the import knows.
inline GlbBuilder richScene() {
    GlbBuilder b = squareScene();
    useImage(b, {{"bufferView", b.view(kTwoPixels)}, {"mimeType", "image/png"}});
    b.json["samplers"] = {{{"wrapS", 33071}}};
    b.json["textures"][0]["sampler"] = 0;
    b.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
    b.json["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 2;
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
          ["KHR_texture_transform"] = {
        {"offset", {0, 1}}, {"rotation", 1}, {"scale", {.5, .5}}, {"texCoord", 1}};
    nlohmann::json& primitive = b.json["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["attributes"]["COLOR_0"] = b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "VEC3");
    b.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view<uint16_t>({1, 0})}, {"componentType", 5123}}},
        {"values", {{"bufferView", b.view<float>({7, 8, 9})}}}};
    b.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    b.json["nodes"][0]["translation"] = {1, 2, 3};
    b.json["nodes"][0]["camera"] = 0;
    b.node({{"children", {0}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}});
    b.json["scenes"] = {{{"nodes", {1}}}};
    b.json["scene"] = 0;
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", .7}, {"znear", .1}}}}};
    b.json["images"].push_back({{"bufferView", b.view(kLossyWebp)}, {"mimeType", "image/webp"}});
    b.json["textures"].push_back({{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    nlohmann::json& glass = b.json["materials"].emplace_back();
    glass["alphaMode"] = "BLEND";
    glass["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {{"diffuseFactor", {1, .5, 1, .5}},
                                                                  {"diffuseTexture", {{"index", 1}}}};
    glass["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1},
                                                         {"transmissionTexture", {{"index", 1}}}};
    b.json["materials"].push_back({{"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}});
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
    b.node({{"extensions", {{"EXT_lights_area", {{"light", 0}}}}}});
    b.node({{"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}, {"mesh", 0}});
    b.json["nodes"][1]["children"] = {0, 2, 3};
    while (b.bin.size() % 4 != 0)
        b.bin.push_back(0);
    b.json["buffers"] = {{{"byteLength", b.bin.size()}}};
    b.json["extensionsUsed"] = {"KHR_lights_punctual", "EXT_lights_area", "EXT_texture_webp"};
    b.json["extensions"]["EXT_lights_area"]["lights"] = {
        {{"type", "rect"}, {"size", 2}, {"rect", {{"aspect", 2}}}}};
    b.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "night"}}};
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"},
                                                              {"color", {1, 1, 1}},
                                                              {"spot", {{"outerConeAngle", .6}}},
                                                              {"extras", {{"relume", {{"radius", .1}}}}}}};
    b.json["nodes"][0]["extras"]["relume"]["areaLight"] = {
        {"type", "rectangle"}, {"color", {1, 1, 1}}, {"intensity", 2}, {"size", {1, 2}}};
    b.json["scenes"][0]["extras"]["relume"]["sky"] = {
        {"color", {1, 1, 1}}, {"intensity", 2}, {"rotation", 1}};
    return b;
}

} // namespace relume::test
