#include "bake/baker/memory_plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "bake/baker/host_room.h"
#include "bake/baker/make_solver.h"

namespace relume {
namespace {

// A bake may take this share of the free memory: the driver needs some of its own.
constexpr double kMemoryShare = 0.9;
// Sizes that are proposed are multiples of this.
constexpr uint32_t kProposedStep = 64;
constexpr int kMiBShift = 20;

uint64_t limitOf(const BakeRoom& room) {
    return static_cast<uint64_t>(kMemoryShare * static_cast<double>(room.device));
}

/// Holds what a bake takes when so much of it is spilled.
struct Needs {
    Spill spill = Spill::None;
    uint64_t device = 0, host = 0, spilled = 0;

    bool fitsDevice(const BakeRoom& room) const { return device <= limitOf(room); }
    bool fitsHost(const BakeRoom& room) const { return !room.host || host <= *room.host; }
};

Needs needsOf(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room) {
    const MemoryNeeds needs = mostMemoryNeeds(settings, scene, room.software);
    // Spilled buffers take as much as before of a memory that both share.
    const uint64_t alike = room.shared && needs.spilled > 0 ? needs.total() + needs.spilled : 0;
    return {.spill = settings.solver.spill,
            .device = needs.total(),
            .host = std::max(hostNeeds(settings, scene, needs.spilled), alike),
            .spilled = needs.spilled};
}

// Returns the settings without bits and links that are kept, which take what is left.
BakeSettings withoutCache(BakeSettings settings) {
    settings.solver.cache.kind = CacheSettings::Kind::None;
    return settings;
}

// Calls fits(settings) with more and more spilled, at first as it is, and returns with how much it did first;
// all that can be spilled where it never did.
template<typename Fits>
Spill leastSpill(const BakeSettings& settings, const Fits& fits) {
    if (fits(settings)) return settings.solver.spill;
    BakeSettings bare = withoutCache(settings);
    const Spill most = std::max(mostSpill(settings.solver), settings.solver.spill);
    while (!fits(bare) && bare.solver.spill != most)
        bare.solver.spill = static_cast<Spill>(static_cast<int>(bare.solver.spill) + 1);
    return bare.solver.spill;
}

// Returns what a bake of this size takes where it fits, else what it takes when all is spilled that can be.
Needs leastSpilled(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room) {
    Needs needs;
    leastSpill(settings, [&](const BakeSettings& tried) {
        needs = needsOf(tried, scene, room);
        return needs.fitsDevice(room) && needs.fitsHost(room);
    });
    return needs;
}

std::string mendOf(uint32_t fits, const std::string& pages) {
    return fits > 0 ? fmt::format("--size {}{} fits", fits, pages)
                    : std::string("no size fits, close other programs");
}

} // namespace

BakeRoom roomOn(const vk::Device& device) {
    return {.device = device.freeMemory(),
            .host = freeHostMemory(),
            .imageEdge = device.limits().maxImageDimension2D,
            .software = device.info().software(),
            .shared = device.info().sharesMemory(),
            .limited = device.limited(),
            .name = device.info().name};
}

MemoryPlan planMemory(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room) {
    const uint32_t size = settings.size;
    // All pages are drawn side by side as one image.
    const uint32_t imageLimit =
        std::min(kMaxPageSize, scene.pages.edgeOf(std::min(kMaxSheetSize, room.imageEdge)));
    const auto needsAt = [&](uint32_t edge) {
        BakeSettings other = settings;
        other.size = edge;
        return leastSpilled(other, scene, room);
    };
    const auto fitsAt = [&](uint32_t edge) {
        const Needs needs = needsAt(edge);
        return needs.fitsDevice(room) && needs.fitsHost(room);
    };
    const Needs needs = needsAt(size);
    const bool fits = needs.fitsDevice(room) && needs.fitsHost(room);
    if (fits && size <= imageLimit) return {.spill = needs.spill, .spilled = needs.spilled};

    uint32_t largest = std::min(size, imageLimit) / kProposedStep * kProposedStep;
    while (largest > 0 && !fitsAt(largest))
        largest -= kProposedStep;
    const std::string pages = scene.pages.count > 1 ? fmt::format(" of {} pages", scene.pages.count) : "";
    const std::string mend = mendOf(largest, pages);
    if (fits)
        return {.problem = fmt::format("--size {}{} makes a map of {} texels a side, and '{}' takes {}: {}",
                                       size, pages, scene.pages.sheetOf(size), room.name,
                                       scene.pages.sheetOf(imageLimit), mend)};
    if (!needs.fitsDevice(room))
        return {.problem =
                    fmt::format("--size {}{} needs {} MiB on '{}', which has {} MiB to give{}: {}", size,
                                pages, needs.device >> kMiBShift, room.name, limitOf(room) >> kMiBShift,
                                room.limited ? " by --device-memory" : "", mend)};
    return {.problem =
                fmt::format("--size {}{} needs {} MiB of this machine's memory, which has {} MiB free: {}",
                            size, pages, needs.host >> kMiBShift, *room.host >> kMiBShift, mend)};
}

Spill spillOf(const BakeSettings& settings, const SceneExtent& scene, const SolverExtent& solver,
              uint64_t free) {
    return leastSpill(settings, [&](const BakeSettings& tried) {
        return static_cast<double>(memoryNeeds(tried, scene, solver).total()) <=
               kMemoryShare * static_cast<double>(free);
    });
}

} // namespace relume
