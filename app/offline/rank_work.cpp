#include "app/offline/rank_work.h"

#include "assets/base/error.h"
#include "assets/base/log.h"
#include "bake/ranks/mpi_ranks.h"

#include <algorithm>

namespace relume {
namespace {

void silence() {
    spdlog::set_level(spdlog::level::off);
}

// Each process bakes layers of its own: none knows how far those of the others are, or has them before the
// end.
void checkSharedLayers(const BakeOptions& options, const SolverSettings& solver, uint32_t ranks) {
    if (solver.links.samples == 0 || solver.error > 0 || solver.localError > 0)
        throw UsageError(
            fmt::format("--layers: {} processes bake lights of their own, so each layer must stop by "
                        "itself: give --samples, with or without --layer-error, and no --error",
                        ranks));
    const std::pair<const char*, bool> others[] = {{"--checkpoint", !options.checkpoint.file.empty()},
                                                   {"--resume", !options.checkpoint.resume.empty()},
                                                   {"--error-map", !options.files.errorMap.empty()},
                                                   {"--json", !options.files.json.empty()},
                                                   {"--probes-out", options.probes.wanted()}};
    for (const auto& [name, given] : others)
        if (given)
            throw UsageError(
                fmt::format("{}: none of {} processes has the layers of all lights: leave it out, or "
                            "start --layers without mpirun",
                            name, ranks));
}

} // namespace

void runOnRanks(const Launch& launch, const std::function<void(Ranks&)>& work) {
    if (!launch.several()) return work(oneProcess());
    const std::unique_ptr<Ranks> ranks = startMpi(launch);
    if (const Cores cores = coresOfProcess(); boundTight(cores, launch.localCount))
        spdlog::warn(
            "{} processes on this machine are bound to {} of its {} cores each: mpirun --bind-to none leaves "
            "them all",
            launch.localCount, cores.usable, cores.all);
    try {
        work(*ranks);
        ranks->finish();
    } catch (const OtherRankFailed& failed) {
        silence();
        throw Error(failed.what());
    } catch (...) {
        if (!ranks->fail())
            silence();
        else if (!ranks->speaks())
            spdlog::set_level(spdlog::level::err);
        throw;
    }
}

void checkSharedBake(const BakeOptions& options, const BakeRequest& request, uint32_t ranks) {
    if (ranks == 1) return;
    const SolverSettings& solver = request.bake.solver;
    const std::string mend = fmt::format(": {} processes cannot share it, start it without mpirun", ranks);
    if (solver.layers.on) checkSharedLayers(options, solver, ranks);
    if (solver.links.indirectScale > 1)
        throw UsageError(fmt::format("--indirect-scale {}{}", solver.links.indirectScale, mend));
}

void requireAlike(Ranks& ranks, const std::string& what) {
    if (ranks.alone()) return;
    constexpr size_t kBytes = 1024; // of what a rank says
    std::string own = what.substr(0, kBytes);
    own.resize(kBytes, '\0');
    std::string all(kBytes * ranks.count(), '\0');
    const std::vector<uint64_t> sizes(ranks.count(), kBytes);
    ranks.gather(std::as_bytes(std::span(own)), std::as_writable_bytes(std::span(all)), sizes);
    for (uint32_t rank = 1; rank < ranks.count(); ++rank) {
        const std::string first = all.substr(0, kBytes), other = all.substr(rank * kBytes, kBytes);
        if (other == first) continue;
        throw Error(
            fmt::format("process {} bakes {}, process 0 {}: start all of them on machines alike, with the "
                        "same files, and name one kind of device by --device",
                        rank, other.c_str(), first.c_str()));
    }
}

} // namespace relume
