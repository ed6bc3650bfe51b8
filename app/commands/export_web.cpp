#include "app/commands/export_web.h"

#include "app/export/web/web_page.h"
#include "app/offline/command_files.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/progress.h"
#include "app/text/interrupt.h"
#include "app/text/typed_numbers.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"

#include <cstdio>
#include <filesystem>

namespace relume {
namespace {

namespace fs = std::filesystem;

WebDesc descOf(const WebOptions& options, const std::string& exposure) {
    WebDesc desc{
        .path = options.path, .single = options.single, .exposure = typedExposure(exposure), .frames = {}};
    while (desc.path.size() > 1 && desc.path.ends_with('/'))
        desc.path.pop_back();
    if (desc.single && !desc.path.ends_with(".html"))
        throw UsageError("--single-file: the page is one file: give --web a name that ends in .html");
    if (!options.timelapse.empty()) desc.frames = framesIn(options.timelapse);
    return desc;
}

std::string sceneNamedIn(const LayeredImage& image) {
    const auto found = image.composite.attributes.find("relume:scene");
    return found == image.composite.attributes.end() ? "" : found->second;
}

// Returns the scene that lies beside the layers that were baked of it.
std::string sceneBeside(const std::string& layers, const LayeredImage& image) {
    const std::string mend = "write relume export SCENE --layers " + layers + " --web OUT";
    const std::string name = sceneNamedIn(image);
    if (name.empty()) throw Error(layers + ": does not say which scene it belongs to: " + mend);
    const std::string path = (fs::path(layers).parent_path() / name).string();
    std::error_code error;
    if (!fs::exists(path, error)) throw Error(layers + ": its scene " + name + " is not beside it: " + mend);
    return path;
}

} // namespace

void exportWeb(const WebOptions& options, const BakeOptions& bake, const std::string& givenLayers,
               const std::string& exposure) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    const WebDesc desc = descOf(options, exposure);
    const bool alone = bake.files.scene.ends_with(".exr");
    if (alone && !givenLayers.empty())
        throw UsageError("--layers: SCENE holds layers, too: give the scene there, or leave out --layers");
    const std::string layers = alone ? bake.files.scene : givenLayers;
    if (layers.empty())
        throw UsageError("--web: the page needs layers: give LAYERS.exr in place of SCENE, or with --layers; "
                         "'relume bake --layers' writes it");
    BakeOptions loaded = bake;
    CommandFiles files;
    files.readsLightmap("LAYERS", layers);
    if (!alone) files.readsScene("SCENE", bake.files.scene);
    for (const std::string& path : webFiles(desc))
        files.writes("--web", path);
    for (const std::string& path : desc.frames)
        files.reads("--timelapse", path);
    files.check();
    checkWebPage(desc);
    const LayeredImage image = readLayeredLightmap(layers);
    if (alone) loaded.files.scene = sceneBeside(layers, image);
    warnAboutLayers(image, layers, loaded.files.scene);
    BakeRequest request = resolveBakeOptions(loaded);
    matchLightmap(request.prepare, image.composite);
    const PreparedScene prepared = [&] {
        const PhaseProgress phase(true);
        return prepareScene(request.prepare);
    }();
    stopIfInterrupted();
    writeWebPage(desc, prepared.scene, prepared.mesh, image, layers);
    uintmax_t bytes = 0;
    for (const std::string& path : webFiles(desc)) {
        std::printf("%s\n", path.c_str());
        bytes += fs::file_size(path);
    }
    spdlog::info("wrote {} with {} lights, {:.1f} MB ({} in all)", desc.path, image.layers.size(),
                 static_cast<double>(bytes) / 1e6, formatDuration(secondsSince(start)));
}

} // namespace relume
