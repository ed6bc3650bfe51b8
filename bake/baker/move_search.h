#pragma once

#include <functional>

#include "bake/layers/object_move.h"
#include "bake/validity/cover_search.h"
#include "bake/validity/inside_search.h"
#include "bake/vk/commands.h"

namespace relume {

/// Looks anew which patches lie inside something and what stands in their texels, near objects that have
/// moved. It keeps its buffers from one move to the next.
class MoveSearch {
public:
    /// Makes what is needed to follow directions. The things of `on` must outlive it.
    explicit MoveSearch(const CoverSearch& on);
    /// Returns the device bytes that it keeps at most; on a software device those of the host's memory, too.
    static uint64_t bytes(uint32_t chunks, bool software);

    const Tracer& tracer() const { return covers_.on().tracer; }
    CoverSearcher& covers() { return covers_; }
    PlaceSearcher& places() { return places_; }

    /// Follows those directions (kInsideDirections) again that may meet what has moved, those of patches that
    /// send nothing, too. hear(patch, direction, link) hears of each.
    void retrace(const ObjectMove& move,
                 const std::function<void(uint32_t patch, uint32_t direction, uint32_t link)>& hear);

private:
    void put(const ObjectMove& move);
    const vk::Device& device() const { return covers_.on().device; }

    CoverSearcher covers_;
    PlaceSearcher places_;
    uint32_t batch_; // chunks
    vk::Buffer links_, list_, listed_, rays_;
    vk::Buffer boxes_, changed_; // of the last move
    vk::Commands commands_;
};

} // namespace relume
