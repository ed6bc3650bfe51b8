#include "app/commands/export_probes.h"

#include "app/offline/probe_files.h"
#include "assets/base/log.h"

#include <algorithm>

namespace relume {
namespace {

constexpr const char* kPlain = "probes.json";
constexpr const char* kOfThree = "probes.three.json";
constexpr const char* kOfBevy = "probes.ktx2";

std::string lineOf(const std::string& name, const ProbeSet& set) {
    if (name == kOfThree)
        return fmt::format(
            "a group of {} LightProbe objects for THREE.ObjectLoader; three.js lights all of a "
            "scene by each probe in it: add the nearest one to what moves",
            set.probes.size());
    if (name == kOfBevy)
        return fmt::format("an IrradianceVolume of intensity 1 at {}; its entity needs a LightProbe",
                           volumePlace(*set.grid));
    return fmt::format("the light of {} places in space, as spherical harmonics of radiance in cd/m^2",
                       set.probes.size());
}

} // namespace

std::vector<ExportExtra> probeExtras(Engine engine, const std::string& path) {
    if (path.empty()) return {};
    std::vector<ExportExtra> extras{{.name = kPlain}};
    if (engine == Engine::Three) extras.push_back({.name = kOfThree});
    if (engine == Engine::Bevy) extras.push_back({.name = kOfBevy});
    return extras;
}

std::vector<ExportExtra> readProbeExtras(Engine engine, const std::string& path, const LayeredImage* layers) {
    std::vector<ExportExtra> extras = probeExtras(engine, path);
    if (extras.empty()) return extras;
    ProbeSet set = readProbes(path);
    if (layers != nullptr && !set.layers.empty()) weighLike(set, *layers);
    if (!set.grid &&
        std::erase_if(extras, [](const ExportExtra& extra) { return extra.name == kOfBevy; }) > 0)
        spdlog::warn("{}: its probes are no grid, which Bevy's volume is: bake them with --probes SPACING",
                     path);
    for (ExportExtra& extra : extras) {
        extra.bytes = probeBytes(extra.name, set);
        extra.line = lineOf(extra.name, set);
    }
    return extras;
}

} // namespace relume
