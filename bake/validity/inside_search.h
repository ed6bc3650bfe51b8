#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bake/validity/met_bits.h"
#include "bake/base/chunk_order.h"
#include "bake/surface/patches.h"
#include "bake/trace/tracer.h"

namespace relume {

/// The things that a search for patches that lie inside something works with.
struct InsideSearch {
    const vk::Device& device;
    Tracer& tracer;
    const PatchSet& patches;
    std::vector<ChunkRange> chunks;      // that are asked, ascending
    std::vector<MetBits>* met = nullptr; // per patch, padding included: gets what was followed, where given
    std::vector<uint32_t>* touching = nullptr; // gets the patches of mayTouch(), ascending, where given
    std::function<void(double done)> onBatch;  // before each batch; what it throws ends the search
};

/// Returns the patches of these chunks that lie inside something (insideBy), ascending. It works in short
/// batches of closest hits, and follows no more directions of a patch than it takes on a CPU, of a chunk on a
/// GPU.
std::vector<uint32_t> findInside(const InsideSearch& search);
/// Returns the device bytes that it takes, on a software device or a GPU.
uint64_t insideBytes(uint32_t chunks, bool software);

/// Says where a place lies; Touching: outside, but mayTouch().
enum class PlaceKind : uint8_t { Outside, Touching, Inside };

/// Finds out which places lie inside something. It keeps its buffers from one search to the next.
class PlaceSearcher {
public:
    PlaceSearcher(const vk::Device& device, Tracer& tracer);
    ~PlaceSearcher();

    /// Returns where each of these places lies. They stand in for patches, whose directions they follow, no
    /// more than it takes. onBatch is called before each batch, where there is one.
    std::vector<PlaceKind> kindsOf(std::span<const shader::Patch> places,
                                   const std::function<void(double done)>& onBatch = {});

private:
    class Steps;
    const vk::Device& device_;
    Tracer& tracer_;
    std::unique_ptr<Steps> steps_; // once there is something to search for
};
/// Returns the device bytes that it keeps for so many chunks of places; on a software device those of the
/// host's memory, too.
uint64_t placeSearchBytes(uint32_t chunks, bool software);

/// Follows all directions of these patches; `met` is as above. It takes as much memory as their number asks
/// for.
void followAll(const vk::Device& device, Tracer& tracer, const PatchSet& patches,
               std::span<const uint32_t> which, std::vector<MetBits>& met);

} // namespace relume
