#include "bake/ranks/launch.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

#include <sched.h>
#include <unistd.h>

namespace relume {
namespace {

std::optional<uint32_t> numberIn(const Environment& environment, const char* name) {
    const char* text = environment(name);
    if (text == nullptr || *text == '\0') return {};
    char* end = nullptr;
    const unsigned long value = std::strtoul(text, &end, 10);
    if (*end != '\0' || value > UINT32_MAX) return {};
    return static_cast<uint32_t>(value);
}

// The names of what a launcher says, in the order in which they are looked at. Where it does not say how many
// processes are on this machine, all are taken to be here.
struct Names {
    const char* rank;
    const char* count;
    const char* localRank;
    const char* localCount;
};
constexpr Names kLaunchers[] = {
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_RANK",
     "OMPI_COMM_WORLD_LOCAL_SIZE"},
    {"PMI_RANK", "PMI_SIZE", "MPI_LOCALRANKID", "MPI_LOCALNRANKS"},
    // srun says how many there are itself; PMI_RANK and PMIX_RANK say that they can speak to each other.
    {"PMI_RANK", "SLURM_STEP_NUM_TASKS", "SLURM_LOCALID", ""},
    {"PMIX_RANK", "SLURM_STEP_NUM_TASKS", "SLURM_LOCALID", ""},
};

// Reads how many tasks this node has, of a list of all nodes such as "4(x2),3": they are alike but for the
// last ones, so the first number is taken.
std::optional<uint32_t> tasksOfNode(const Environment& environment) {
    const char* text = environment("SLURM_STEP_TASKS_PER_NODE");
    if (text == nullptr) return {};
    const unsigned long first = std::strtoul(text, nullptr, 10);
    return first > 0 && first <= UINT32_MAX ? std::optional(static_cast<uint32_t>(first)) : std::nullopt;
}

} // namespace

Launch launchOf(const Environment& environment) {
    for (const Names& names : kLaunchers) {
        const std::optional<uint32_t> rank = numberIn(environment, names.rank);
        const std::optional<uint32_t> count = numberIn(environment, names.count);
        if (!rank || !count || *rank >= *count) continue;
        Launch launch{.byLauncher = true, .rank = *rank, .count = *count};
        const std::optional<uint32_t> localRank = numberIn(environment, names.localRank);
        const std::optional<uint32_t> slurmRank = numberIn(environment, "SLURM_LOCALID");
        launch.localRank = localRank.value_or(slurmRank.value_or(*rank));
        launch.localCount =
            numberIn(environment, names.localCount).value_or(tasksOfNode(environment).value_or(*count));
        launch.localCount = std::max(launch.localCount, launch.localRank + 1);
        return launch;
    }
    return {};
}

Launch launchOfProcess() {
    return launchOf([](const char* name) { return std::getenv(name); });
}

Cores coresOfProcess() {
    const auto all = static_cast<uint32_t>(std::max(1L, sysconf(_SC_NPROCESSORS_ONLN)));
    cpu_set_t bound;
    CPU_ZERO(&bound);
    const bool known = sched_getaffinity(0, sizeof(bound), &bound) == 0;
    return {known ? static_cast<uint32_t>(CPU_COUNT(&bound)) : all, all};
}

uint32_t threadShare(const Cores& cores, uint32_t localCount) {
    if (cores.usable < cores.all) return std::max(1u, cores.usable);
    return std::max(1u, cores.all / std::max(1u, localCount));
}

bool boundTight(const Cores& cores, uint32_t localCount) {
    return cores.usable < cores.all && cores.usable < cores.all / std::max(1u, localCount);
}

void takeThreadShare(const Launch& launch) {
    if (!launch.several()) return;
    const std::string threads = std::to_string(threadShare(coresOfProcess(), launch.localCount));
    for (const char* name : {"RELUME_THREADS", "LP_NUM_THREADS"})
        setenv(name, threads.c_str(), 0);
}

} // namespace relume
