#include "app/export/export_folder.h"

#include "app/export/any_scene.h"
#include "app/export/engine_scene.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/warnings.h"
#include "assets/gltf/gltf.h"
#include "assets/images/paged_image.h"
#include "renderer/good_view.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <glm/gtc/matrix_inverse.hpp>
#include <spdlog/spdlog.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSceneName = "scene.glb";
constexpr const char* kTextureName = "lightmap.ktx2";
constexpr const char* kImageName = "lightmap.exr";
constexpr const char* kReadmeName = "README.txt";
constexpr float kUsualAspect = 16.0f / 9.0f;
// The texture of Engine::Any has the surfaces' pictures in it, which the lightmap's texels are too coarse
// for.
constexpr uint32_t kFiner = 4, kMostFine = 4096; // times; edge [texels]
constexpr uint32_t kMostTexture = 16384;         // edge that engines draw with on usual devices [texels]

uint32_t textureSize(const ExportDesc& desc, const Scene& scene, uint32_t lightmap) {
    if (desc.engine != Engine::Any) return lightmap;
    if (desc.textureSize > 0) return desc.textureSize;
    const bool hasPictures =
        std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
            return m.baseColorTexture.texture >= 0 || m.emissionTexture.texture >= 0;
        });
    return hasPictures ? std::max(lightmap, std::min(kFiner * lightmap, kMostFine)) : lightmap;
}

// Returns the mean of the texels that belong to surfaces [cd/m^2]. Where the lightmap does not say which do,
// `light` does.
glm::vec3 meanLight(const FloatImage& lightmap, const SurfaceLight& light) {
    const std::vector<float>* coverage = lightmap.find("coverage");
    const bool bySurfaces = coverage == nullptr && light.size == lightmap.width;
    glm::dvec3 sum(0.0);
    double count = 0;
    for (size_t i = 0; i < size_t{lightmap.width} * lightmap.height; ++i) {
        if (coverage && (*coverage)[i] < 1.0f) continue;
        if (bySurfaces && light.material[i] == 0) continue;
        for (int c = 0; c < 3; ++c)
            sum[c] += (*lightmap.find(std::string(1, "RGB"[c])))[i];
        count += 1;
    }
    return count > 0 ? glm::vec3(sum / count) : glm::vec3(0.0f);
}

// Returns what the sky looks like on the whole [cd/m^2]: engines show a colour behind the level.
glm::vec3 meanOf(const Sky& sky) {
    if (sky.pixels.empty()) return sky.radiance;
    glm::dvec3 sum(0.0);
    double weights = 0;
    for (uint32_t y = 0; y < sky.height; ++y) {
        const double weight = std::sin(std::numbers::pi * (y + 0.5) / sky.height); // of a row's solid angle
        for (uint32_t x = 0; x < sky.width; ++x)
            sum += weight * glm::dvec3(sky.pixels[size_t{y} * sky.width + x]);
        weights += weight * sky.width;
    }
    return sky.radiance * glm::vec3(sum / weights);
}

// Brings emission to the screen.
void exposeEmission(Scene& scene, float exposure) {
    for (Material& material : scene.materials)
        material.emission *= std::exp2(exposure);
}

// Ends what a screen shows at white, for an importer that knows no emission above 1.
void endEmissionAtWhite(Scene& scene) {
    for (Material& material : scene.materials)
        material.emission /= std::max({1.0f, material.emission.r, material.emission.g, material.emission.b});
}

// three.js reads four sets of UVs, Babylon.js six and Blender eight; glTF promises two.
bool readsThirdSet(Engine engine) {
    return engine == Engine::Three || engine == Engine::Babylon || engine == Engine::Blender;
}

// Godot passes over KHR_materials_transmission, and PlayCanvas shows glass as black where no camera keeps
// what is behind it.
bool showsTransmission(Engine engine) {
    return engine != Engine::Godot && engine != Engine::PlayCanvas;
}

// Turns UVs as textures are turned: Godot knows no rotation, and one transform for all textures of a
// material.
void giveGodotItsUvs(Scene& scene, const std::string& path) {
    for (const std::string& name : applyTextureTransforms(scene))
        spdlog::warn(
            "{}: material {} has textures of several texture transforms, of which godot reads one: give "
            "them the same",
            path, inQuotes(name));
}

Camera startCamera(const WorldMesh& mesh) {
    const ViewCamera view = goodView(mesh, kUsualAspect);
    Camera camera;
    camera.name = "View";
    camera.transform = glm::inverse(viewMatrix(view));
    camera.yfov = view.yfov;
    camera.znear = view.znear;
    return camera;
}

// Returns the lightmap's pages, or the lightmap where it has one.
std::vector<FloatImage> pagesOf(const FloatImage& lightmap) {
    const LightmapPages pages = lightmapPagesOf(lightmap);
    if (pages.count == 1) return {lightmap};
    std::vector<FloatImage> all;
    for (uint32_t page = 0; page < pages.count; ++page)
        all.push_back(pageOf(lightmap, page));
    return all;
}

// Adds a page of the lightmap as a picture of 8 bits, in shares of look.intensity.
void addPage(Scene& scene, const FloatImage& page, const std::string& name, GlbLook& look) {
    Image image{name, page.width, page.height, {}};
    const size_t count = size_t{page.width} * page.height;
    image.rgba.assign(4 * count, 255);
    for (size_t c = 0; c < 3; ++c) {
        const std::vector<float>& plane = *page.find(std::string(1, "RGB"[c]));
        for (size_t i = 0; i < count; ++i) {
            const float share = std::clamp(plane[i] / look.intensity, 0.0f, 1.0f);
            image.rgba[4 * i + c] = static_cast<uint8_t>(std::lround(255.0f * share));
        }
    }
    look.lightmaps.push_back(static_cast<int>(scene.textures.size()));
    look.maps.push_back(look.lightmaps.back());
    scene.textures.push_back({.image = static_cast<int>(scene.images.size()),
                              .wrapS = Wrap::ClampToEdge,
                              .wrapT = Wrap::ClampToEdge});
    scene.images.push_back(std::move(image));
}

// Adds the lightmap, page by page, as MOZ_lightmap has it, and says so in `look`.
void addLightmap(Scene& scene, const std::vector<FloatImage>& pages, GlbLook& look) {
    float brightest = 0.0f;
    for (const FloatImage& page : pages)
        for (const char* channel : {"R", "G", "B"})
            for (const float value : *page.find(channel))
                brightest = std::max(brightest, value);
    look.intensity = brightest > 0.0f ? brightest : 1.0f;
    for (size_t i = 0; i < pages.size(); ++i)
        addPage(scene, pages[i], pages.size() > 1 ? fmt::format("Lightmap {}", i) : "Lightmap", look);
}

// Makes one page of all where the engine's files know no pages. Throws Error where it is too large.
void joinPages(Engine engine, LightmapAtlas& atlas, FloatImage& lightmap) {
    if (atlas.pages.count == 1 || knowsPages(engine)) return;
    const std::string& name = engineNames()[static_cast<size_t>(engine)];
    if (lightmap.width > kMostTexture)
        throw Error(fmt::format("--for {0}: takes the {1} pages of the lightmap as one texture, which would "
                                "have {2} texels a side, more than {3}: bake a smaller --size or fewer "
                                "--pages, or export --for three",
                                name, atlas.pages.count, lightmap.width, kMostTexture));
    spdlog::info("for {} the {} pages of the lightmap lie side by side in one texture of {} x {} texels",
                 name, atlas.pages.count, lightmap.width, lightmap.width);
    atlas = onOneSheet(std::move(atlas));
    noteLightmapPages(lightmap, atlas.pages);
}

std::vector<LitMaterial> litMaterials(const EngineScene& level) {
    std::vector<LitMaterial> lit;
    for (size_t i = 0; i < level.scene.materials.size(); ++i)
        if (level.lit[i]) lit.push_back({level.scene.materials[i].name, level.page[i]});
    return lit;
}

std::string linesOf(const std::vector<ExportExtra>& extras) {
    std::string lines = "\n";
    for (const ExportExtra& extra : extras)
        lines += fmt::format("{}  {}\n", extra.name, extra.line);
    return lines;
}

FloatImage colorsOf(const FloatImage& lightmap) {
    FloatImage out{lightmap.width, lightmap.height, {}, {}, lightmap.attributes};
    for (const char* channel : {"R", "G", "B"})
        out.add(channel) = *lightmap.find(channel);
    return out;
}

} // namespace

std::vector<std::string> exportedFiles(const ExportDesc& desc) {
    const fs::path folder = desc.folder;
    std::vector<std::string> paths;
    const LightmapPages pages = knowsPages(desc.engine) ? desc.pages : LightmapPages();
    paths.push_back((folder / kSceneName).string());
    for (const char* name : {kTextureName, kImageName})
        for (const std::string& file : lightmapFiles(name, pages))
            paths.push_back((folder / file).string());
    for (const EngineFile& file : engineFiles(desc.engine, {}))
        paths.push_back((folder / file.name).string());
    for (const ExportExtra& extra : desc.extras)
        paths.push_back((folder / extra.name).string());
    return paths;
}

void checkExport(const ExportDesc& desc) {
    if (!checkFolderWritable(desc.folder)) return;
    for (const std::string& path : exportedFiles(desc))
        checkFileWritable(path, 0);
}

void checkLightmap(const FloatImage& lightmap, const std::string& name) {
    for (const char* channel : {"R", "G", "B"})
        if (!lightmap.find(channel)) throw Error(name + ": has no channels R, G and B: bake a lightmap");
    if (lightmap.width != lightmap.height)
        throw Error(fmt::format("{}: has {} x {} texels, and a lightmap is a square: bake one", name,
                                lightmap.width, lightmap.height));
}

ExportResult exportLevel(const ExportDesc& desc, const vk::Device& device, const AtlasLevel& source,
                         const FloatImage& given) {
    checkLightmap(given, "the lightmap");
    const Scene& scene = source.scene;
    if (lightmapPagesOf(given) != source.atlas.pages)
        throw Error(
            fmt::format("{}: its lightmap UVs are for {} pages and the lightmap has {}: bake it again",
                        scene.path, source.atlas.pages.count, lightmapPagesOf(given).count));
    FloatImage lightmap = given;
    LightmapAtlas atlas = source.atlas;
    joinPages(desc.engine, atlas, lightmap);
    const SurfaceLight light =
        surfaceLight(device, source, lightmap, textureSize(desc, scene, lightmap.width));
    ExportResult result;
    result.exposure = desc.exposure.value_or(exposureOf(light));
    EngineScene level = engineScene(scene, atlas, meanLight(lightmap, light));
    if (!showsTransmission(desc.engine)) blendWhatTransmits(level.scene);
    if (desc.engine == Engine::Godot) giveGodotItsUvs(level.scene, scene.path);
    const std::vector<FloatImage> pages = pagesOf(lightmap);
    if (level.scene.cameras.empty()) level.scene.cameras.push_back(startCamera(source.mesh));
    if (!readsThirdSet(desc.engine))
        for (const std::string& name : meshesWithThirdSet(level.scene))
            spdlog::warn("{}: mesh {} reads a texture by a third UV set, which {} may not: let its textures "
                         "share one set",
                         scene.path, inQuotes(name), engineNames()[static_cast<size_t>(desc.engine)]);
    GlbLook look;
    look.matte = !desc.gloss;
    if (desc.engine == Engine::Any) {
        look.maps = lightByEmission(level, light, scene.materials, result.exposure);
    } else {
        addLightmap(level.scene, pages, look);
        look.lit = level.lit;
        look.page = level.page;
        if (desc.engine == Engine::Unity || desc.engine == Engine::Godot)
            exposeEmission(level.scene, result.exposure);
        if (desc.engine == Engine::Unity) endEmissionAtWhite(level.scene);
    }

    const fs::path folder = desc.folder;
    FolderForFiles place(desc.folder);
    AtomicFiles files(desc.onFailure);
    const auto write = [&](const std::string& name, std::string_view bytes) {
        const std::string path = (folder / name).string();
        files.add(path, bytes);
        result.files.push_back(path);
    };
    const std::vector<uint8_t> glb = glbBytes(level.scene, {}, look);
    write(kSceneName, {reinterpret_cast<const char*>(glb.data()), glb.size()});
    // The loaders for these two are a few lines, which unpack nothing.
    const bool plain = desc.engine == Engine::Babylon || desc.engine == Engine::PlayCanvas;
    const std::vector<std::string> textures = lightmapFiles(kTextureName, atlas.pages),
                                   images = lightmapFiles(kImageName, atlas.pages);
    for (size_t page = 0; page < pages.size(); ++page)
        write(textures[page],
              encodeKtx2(pages[page], {.format = plain ? Ktx2Format::Half : desc.format, .zstd = !plain},
                         (folder / textures[page]).string()));
    for (size_t page = 0; page < pages.size(); ++page)
        write(images[page], encodeImage((folder / images[page]).string(), colorsOf(pages[page])));
    const std::string name = fs::path(scene.path).stem().string();
    for (EngineFile& file : engineFiles(desc.engine, {.name = name,
                                                     .exposure = result.exposure,
                                                     .sky = meanOf(scene.sky),
                                                     .pages = atlas.pages.count,
                                                     .lit = litMaterials(level)})) {
        if (file.name == kReadmeName && !desc.extras.empty()) file.text += linesOf(desc.extras);
        write(file.name, file.text);
    }
    for (const ExportExtra& extra : desc.extras)
        write(extra.name, extra.bytes);
    files.commit();
    place.keep();
    return result;
}

} // namespace relume
