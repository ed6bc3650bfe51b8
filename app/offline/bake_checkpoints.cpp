#include "app/offline/bake_checkpoints.h"

#include "app/offline/bake_settings.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"

#include <algorithm>

namespace relume {
namespace {

// Saving may take this share of the time: beyond that it is done less often than asked for.
constexpr double kSavingShare = 0.1;
constexpr double kWorthTelling = 1.0; // [s]

// Makes the text one value in a list that is separated by spaces.
std::string oneWord(std::string text) {
    std::replace(text.begin(), text.end(), ' ', '_');
    return text;
}

// Returns how many pages the lightmap has, where there are several: the scene decides it, too.
std::string pagesOf(const Baker& baker) {
    const uint32_t pages = baker.patches().scene.mesh.pages.count;
    return pages > 1 ? fmt::format(" pages={}", pages) : "";
}

// Returns the lights that a job bakes layers of, where it is one: another job's state is of other layers.
std::string lightsOf(const BakeSettings& settings) {
    std::string text;
    for (const std::string& name : settings.solver.layers.lights)
        text += (text.empty() ? " lights=" : ",") + oneWord(name);
    return text;
}

} // namespace

BakeCheckpoints::BakeCheckpoints(const BakeOptions& options, const Ranks& ranks)
    : ranks_(ranks), path_(options.checkpoint.file), shaders_(options.machine.shaders),
      every_(options.checkpoint.every) {
    if (!options.checkpoint.resume.empty()) resumed_.emplace(options.checkpoint.resume, RELUME_VERSION);
    if (!path_.empty() && ranks_.speaks()) checkFileWritable(path_, 0);
}

void BakeCheckpoints::begin(Baker& baker, const Scene& scene, const BakeSettings& settings,
                            const vk::DeviceInfo& device) {
    if (path_.empty() && !resumed_) return;
    key_.version = RELUME_VERSION;
    key_.settings =
        describeSettings(settings) + lightsOf(settings) + pagesOf(baker) +
        fmt::format(" tracer={} device={} driver={} shaders={}", baker.tracer().name(), oneWord(device.name),
                    oneWord(device.driver), shaders_.empty() ? "built-in" : oneWord(shaders_));
    key_.scene = sceneFingerprint(scene, baker.patches());
    if (!path_.empty() && ranks_.speaks()) {
        uint64_t bytes = 0;
        for (const StatePart& part : baker.solver().stateParts())
            bytes += part.bytes;
        checkFileWritable(path_, bytes);
    }
    if (resumed_) {
        resumed_->restore(key_, baker.solver());
        resumed_.reset();
        const SolverProgress& progress = baker.solver().progress();
        spdlog::info("resumed after {} passes, {:.3g} Mrays", progress.passes,
                     static_cast<double>(progress.rays) * 1e-6);
    }
    next_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(every_);
}

void BakeCheckpoints::save(Solver& solver, OnFailure onFailure) {
    const auto start = Clock::now();
    solver.collect();
    if (!ranks_.speaks()) return;
    const uint64_t bytes = saveCheckpoint(path_, key_, solver, onFailure);
    const auto end = Clock::now();
    const std::chrono::duration<double> took = end - start;
    if (took.count() > kWorthTelling)
        spdlog::info("checkpoint: {} MiB in {:.1f} s", bytes >> 20, took.count());
    const auto pause = std::max(every_, took * (1.0 / kSavingShare - 1.0));
    next_ = end + std::chrono::duration_cast<Clock::duration>(pause);
}

void BakeCheckpoints::afterStep(Solver& solver) {
    if (path_.empty() || (ranks_.alone() && !due())) return; // else all were called as the first one's is due
    try {
        save(solver, OnFailure::Drop); // the next one will do
    } catch (const Error& error) {
        spdlog::warn("no checkpoint: {}", error.what());
        next_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(every_);
    }
}

void BakeCheckpoints::interrupt(Solver& solver) {
    if (path_.empty()) throw Error("interrupted: nothing was written");
    try {
        save(solver, OnFailure::Keep);
    } catch (const Error& error) {
        throw Error(std::string("interrupted: ") + error.what());
    }
    throw Error("interrupted: go on with --resume " + path_);
}

} // namespace relume
