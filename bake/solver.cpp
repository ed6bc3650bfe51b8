#include "bake/solver.h"

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
    return std::make_unique<PairSolver>(input, settings);
}

uint64_t solverBytes(uint32_t chunkCount, bool software, const SolverSettings&) {
    return PairSolver::bytes(chunkCount, software);
}

} // namespace relume
