#include "bake/baker/fitting_size.h"

#include <algorithm>

#include "bake/baker/host_room.h"

namespace relume {
namespace {

constexpr uint64_t kShare = 2; // one part in so many of the room

bool fits(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room) {
    if (scene.pages.sheetOf(settings.size) > std::min(kMaxSheetSize, room.imageEdge)) return false;
    return mostMemoryNeeds(settings, scene, room.software).total() <= room.device / kShare &&
           (!room.host || hostNeeds(settings, scene) <= *room.host / kShare);
}

} // namespace

uint32_t fittingSize(const BakeSettings& settings, const SceneExtent& scene, const BakeRoom& room,
                     uint32_t least, uint32_t most) {
    const auto below = [](uint32_t size) {
        return size > kSizeStride ? (size - 1) / kSizeStride * kSizeStride : size / 2;
    };
    BakeSettings smaller = settings;
    for (smaller.size = std::min(most, kMaxPageSize); smaller.size > least;
         smaller.size = below(smaller.size))
        if (fits(smaller, scene, room)) return smaller.size;
    return least;
}

} // namespace relume
