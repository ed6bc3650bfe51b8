#include "app/export/web/web_scene.h"

#include "app/export/web/web_light.h"
#include "app/export/web/web_picture.h"
#include "assets/base/log.h"
#include "assets/images/box_filter.h"
#include "assets/images/shared_exponent.h"
#include "renderer/camera.h"
#include "renderer/good_view.h"
#include "renderer/scene_geometry.h"

#include <algorithm>
#include <map>

namespace relume {
namespace {

using nlohmann::json;

constexpr float kPageAspect = 16.0f / 9.0f;
constexpr int kNone = -1; // in place of a section's number

json numbers(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

template<class T, class Get>
std::vector<T> gathered(const std::vector<SceneVertex>& vertices, Get get) {
    std::vector<T> out;
    out.reserve(vertices.size());
    for (const SceneVertex& vertex : vertices)
        out.push_back(get(vertex));
    return out;
}

template<class T>
int section(WebContainer& to, const std::vector<T>& values) {
    return to.addValues(std::span<const T>(values));
}

// Floats are added one by one: the bytes of x, y and z are as much alike as those of one of them.
template<glm::length_t N>
int floatSection(WebContainer& to, const std::vector<glm::vec<N, float>>& values) {
    return to.addValues(std::span<const float>(&values.data()->x, size_t{N} * values.size()));
}

void addTriangles(WebContainer& to, const SceneGeometry& geometry) {
    const std::vector<SceneVertex>& vertices = geometry.vertices;
    json& out = to.header["geometry"];
    const auto vec2Of = [&](auto get) { return gathered<glm::vec2>(vertices, get); };
    const auto base = vec2Of([](const SceneVertex& v) { return v.baseUv; });
    const auto emission = vec2Of([](const SceneVertex& v) { return v.emissionUv; });
    const auto metallic = vec2Of([](const SceneVertex& v) { return v.metallicUv; });
    const auto colors = gathered<glm::vec4>(vertices, [](const SceneVertex& v) { return v.color; });
    const bool colored =
        std::any_of(colors.begin(), colors.end(), [](const glm::vec4& c) { return c != glm::vec4(1.0f); });
    out["vertices"] = vertices.size();
    out["positions"] =
        floatSection(to, gathered<glm::vec3>(vertices, [](const SceneVertex& v) { return v.position; }));
    // What has a lightmap everywhere needs neither normals nor a mark on its vertices.
    const bool whole = std::all_of(geometry.draws.begin(), geometry.draws.end(),
                                   [](const SceneDraw& draw) { return draw.mapped == shader::kMappedAll; });
    out["normals"] = whole ? kNone : floatSection(to, gathered<glm::vec3>(vertices, [](const SceneVertex& v) {
                                                      return v.normal;
                                                  }));
    out["lightmapUv"] =
        floatSection(to, gathered<glm::vec2>(vertices, [](const SceneVertex& v) { return v.lightmapUv; }));
    out["baseUv"] = floatSection(to, base);
    out["emissionUv"] = emission == base ? out["baseUv"].get<int>() : floatSection(to, emission);
    out["metallicUv"] = metallic == base ? out["baseUv"].get<int>() : floatSection(to, metallic);
    out["colors"] = colored ? floatSection(to, colors) : kNone;
    out["mapped"] = whole ? kNone : section(to, gathered<uint8_t>(vertices, [](const SceneVertex& v) {
                                                return static_cast<uint8_t>(v.mapped);
                                            }));
    out["indices"] = section(to, geometry.indices);
}

void addDraws(WebContainer& to, const Scene& scene, const SceneGeometry& geometry,
              const LightLayers& lights) {
    json& draws = to.header["draws"] = json::array();
    for (const SceneDraw& draw : geometry.draws) {
        if (draw.instance < scene.instances.size() && scene.instances[draw.instance].hidden) continue;
        draws.push_back({{"first", draw.firstIndex},
                         {"count", draw.indexCount},
                         {"material", draw.material},
                         {"doubleSided", draw.doubleSided},
                         {"pane", draw.pane},
                         {"mapped", draw.mapped},
                         {"light", lights.of({LightKey::Kind::Emitter, draw.instance, draw.material})},
                         {"low", numbers(draw.bounds.low)},
                         {"high", numbers(draw.bounds.high)}});
    }
    to.header["bounds"] = {{"low", numbers(geometry.bounds.low)}, {"high", numbers(geometry.bounds.high)}};
}

// Adds textures as materials read them, each once.
class WebTextures {
public:
    WebTextures(WebContainer& to, const Scene& scene) : to_(to), scene_(scene) {
        to.header["textures"] = json::array();
    }

    int of(const TextureRef& use, bool srgb) {
        if (use.texture < 0) return kNone;
        const Texture& texture = scene_.textures[static_cast<size_t>(use.texture)];
        if (texture.image < 0) return kNone;
        const auto [known, isNew] = numbers_.try_emplace({use.texture, srgb}, kNone);
        if (isNew) {
            json& textures = to_.header["textures"];
            known->second = static_cast<int>(textures.size());
            textures.push_back({{"picture", pictureOf(texture.image, srgb)},
                                {"srgb", srgb},
                                {"wrapS", static_cast<int>(texture.wrapS)},
                                {"wrapT", static_cast<int>(texture.wrapT)},
                                {"nearest", texture.nearest}});
        }
        return known->second;
    }

private:
    int pictureOf(int number, bool srgb) {
        const auto [known, isNew] = pictures_.try_emplace(number, kNone);
        if (!isNew) return known->second;
        const Image& image = scene_.images[static_cast<size_t>(number)];
        if (std::max(image.width, image.height) <= kMostWebp) return known->second = to_.add(webpOf(image));
        spdlog::warn("{}: {}: {}", scene_.path, imageName(scene_, number),
                     tooLarge(image.width, image.height, kMostWebp, "WebP"));
        return known->second = to_.add(webpOf(shrunkTo(kMostWebp, image, srgb)));
    }

    WebContainer& to_;
    const Scene& scene_;
    std::map<std::pair<int, bool>, int> numbers_; // by Scene::textures and whether it is sRGB
    std::map<int, int> pictures_;                 // by Scene::images
};

void addMaterials(WebContainer& to, const Scene& scene) {
    WebTextures textures(to, scene);
    json& out = to.header["materials"] = json::array();
    const auto add = [&](const Material& m) {
        const bool masked = m.alphaMode == AlphaMode::Mask;
        out.push_back({{"base", {m.baseColor.r, m.baseColor.g, m.baseColor.b, m.baseColor.a}},
                       {"emission", numbers(m.emission)},
                       {"masked", masked},
                       {"cutoff", masked ? m.alphaCutoff : 0.0f},
                       {"metallic", m.metallic},
                       {"roughness", m.roughness},
                       {"transmission", m.transmission},
                       {"blends", m.alphaMode == AlphaMode::Blend},
                       {"baseTexture", textures.of(m.baseColorTexture, true)},
                       {"emissionTexture", textures.of(m.emissionTexture, true)},
                       {"metallicTexture", textures.of(m.metallicRoughnessTexture, false)}});
    };
    for (const Material& material : scene.materials)
        add(material);
    add({}); // of triangles without a material, as glTF has it
}

void addCameras(WebContainer& to, const Scene& scene, const WorldMesh& mesh) {
    json& out = to.header["cameras"] = json::array();
    const auto add = [&](const std::string& name, const ViewCamera& c) {
        out.push_back({{"name", name},
                       {"eye", numbers(c.eye)},
                       {"target", numbers(c.target)},
                       {"up", numbers(c.up)},
                       {"yfov", c.yfov},
                       {"halfHeight", c.halfHeight},
                       {"znear", c.znear},
                       {"zfar", c.zfar}});
    };
    const Box bounds = boundsOf(mesh);
    for (const Camera& camera : scene.cameras)
        add(camera.name, cameraOfFile(camera, bounds));
    if (scene.cameras.empty()) add("View", goodView(mesh, kPageAspect));
}

void addSky(WebContainer& to, const Sky& sky, const LightLayers& lights) {
    json& out = to.header["sky"];
    out = {{"radiance", numbers(sky.radiance)},
           {"rotation", sky.rotation},
           {"width", sky.width},
           {"height", sky.height},
           {"light", lights.of({LightKey::Kind::Sky, 0, 0})},
           {"picture", kNone}};
    if (sky.pixels.empty()) return;
    std::vector<uint32_t> texels;
    texels.reserve(sky.pixels.size());
    for (const glm::vec3& pixel : sky.pixels)
        texels.push_back(packSharedExponent(glm::clamp(pixel, 0.0f, kMostSharedExponent)));
    out["picture"] = section(to, texels);
}

} // namespace

void addScene(WebContainer& to, const Scene& scene, const WorldMesh& mesh, const LayeredImage& image) {
    const LightLayers lights(scene, image);
    const SceneGeometry geometry = makeGeometry(scene, mesh);
    addTriangles(to, geometry);
    addDraws(to, scene, geometry, lights);
    addMaterials(to, scene);
    addCameras(to, scene, mesh);
    addSky(to, scene.sky, lights);
}

} // namespace relume
