#include "bake/solver.h"

#include "bake/link_solver.h"
#include "bake/pair_solver.h"

#include <array>

namespace relume {
namespace {

struct Name {
    Method method;
    const char* name;
};
constexpr std::array<Name, 7> kNames = {{{Method::Pure, "pure"},
                                         {Method::Static, "static"},
                                         {Method::MonteCarlo, "montecarlo"},
                                         {Method::Mipmapped, "mipmapped"},
                                         {Method::Adaptive, "adaptive"},
                                         {Method::Directional, "directional"},
                                         {Method::Hybrid, "hybrid"}}};

// Of the free device memory that bits and links may take if nothing else is said.
constexpr double kCacheShare = 1.0 / 3.0;

} // namespace

Method parseMethod(const std::string& name) {
    for (const Name& n : kNames) {
        if (name == n.name) return n.method;
    }
    throw UsageError(
        "--method " + name +
        ": unknown; choose pure, static, montecarlo, mipmapped, adaptive, directional or hybrid");
}

const char* methodName(Method method) {
    for (const Name& n : kNames) {
        if (method == n.method) return n.name;
    }
    return "";
}

std::unique_ptr<Solver> makeSolver(const SolverInput& input, const SolverSettings& settings) {
    SolverSettings complete = settings;
    if (complete.cache.bytes == 0)
        complete.cache.bytes =
            static_cast<uint64_t>(kCacheShare * static_cast<double>(input.device.freeMemory()));
    if (isPairMethod(settings.method)) return std::make_unique<PairSolver>(input, complete);
    return std::make_unique<LinkSolver>(input, complete);
}

uint64_t solverBytes(uint32_t chunkCount, bool software, const SolverSettings& settings) {
    if (!isPairMethod(settings.method)) return LinkBuffers::bytes(chunkCount, software, settings);
    return PairSolver::bytes(chunkCount, software, settings);
}

} // namespace relume
