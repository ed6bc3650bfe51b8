#include "app/offline/probe_files.h"

#include "app/offline/probe_forms.h"
#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/images/ktx2.h"

namespace relume {
namespace {

// Larger files are none of ours: so much is the largest grid with the light of some hundred lights.
constexpr uint64_t kMostProbeFileBytes = uint64_t{4} << 30;

std::string volumeBytes(const std::string& path, const ProbeSet& set) {
    if (!set.grid)
        throw Error(path +
                    ": a volume needs a grid of probes: bake them with --probes SPACING, or take .json");
    const std::string problem = volumeProblem(*set.grid);
    if (!problem.empty()) throw Error(path + ": " + problem);
    for (const Probe& probe : set.probes)
        requireFiniteLight(probe.radiance, path);
    // A few hundred kilobytes are not worth the decoder that Bevy may have been built without.
    return encodeKtx2(ambientCubes(*set.grid, set.probes), {.zstd = false, .depth = 3 * set.grid->counts.z},
                      path);
}

} // namespace

ProbeForm probeFormOf(const std::string& option, const std::string& path) {
    if (path.ends_with(".three.json")) return ProbeForm::Three;
    if (path.ends_with(".json")) return ProbeForm::Relume;
    if (path.ends_with(".ktx2")) return ProbeForm::Bevy;
    throw UsageError(option + ": '" + path + "' does not end in .json, .three.json or .ktx2");
}

ProbeSet readProbes(const std::string& path) {
    RegularFile file(path, "name a file that 'relume bake --probes-out' wrote");
    if (file.size() > kMostProbeFileBytes)
        throw Error(path +
                    ": is too large for light probes: take a file that 'relume bake --probes-out' wrote");
    std::string text(file.size(), '\0');
    file.read(text.data(), text.size());
    return parseProbes(text, path);
}

std::string volumePlace(const ProbeGrid& grid) {
    const glm::vec3 scale = grid.spacing * glm::vec3(grid.counts);
    const glm::vec3 middle = grid.first + 0.5f * (scale - grid.spacing);
    return fmt::format("translation {:g}, {:g}, {:g}, scale {:g}, {:g}, {:g}", middle.x, middle.y, middle.z,
                       scale.x, scale.y, scale.z);
}

std::string probeBytes(const std::string& path, const ProbeSet& set) {
    switch (probeFormOf("--probes-out", path)) {
    case ProbeForm::Three:
        return threeProbes(set, path);
    case ProbeForm::Bevy:
        return volumeBytes(path, set);
    case ProbeForm::Relume:
        break;
    }
    return probesJson(set, path);
}

void writeProbes(const std::string& path, const ProbeSet& set) {
    writeFileAtomically(path, probeBytes(path, set));
    if (probeFormOf("--probes-out", path) == ProbeForm::Bevy)
        spdlog::info("{}: in Bevy an IrradianceVolume of intensity 1 at {}", path, volumePlace(*set.grid));
    spdlog::info("wrote {}", path);
}

} // namespace relume
