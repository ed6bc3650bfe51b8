#pragma once

#include <optional>

#include "app/live/bake_desk.h"
#include "bake/show/patch_inspector.h"

namespace relume {

/// Tells whether the content changes while a bake goes on.
bool follows(MapContent content);
/// Tells whether the content is drawn as it is, without a unit: colours, directions and marks.
bool isPlain(MapContent content);

/// The range of what patches hold.
struct ValueRange {
    float low = 0, high = 0; // of R
    float largest = 0;       // of all channels, without their sign
};
ValueRange rangeOf(const PatchValues& values, const PatchSet& patches);

/// Looks at what a bake works with beside the light that it shows: values of all patches as a map has them,
/// and the light paths and voxels that no map can hold. Only the bake thread uses it.
class BakeInspection {
public:
    /// The baker and its solver's settings must outlive it.
    BakeInspection(const vk::Device& device, Baker& baker, const SolverSettings& settings);

    /// Returns what was asked for, 0 where it cannot be told yet. The content is not Light.
    PatchValues values(const InspectRequest& request);
    /// Returns the patch that a texel shows, v * size + u; shader::kNoPatch beside all charts.
    uint32_t patchAt(uint32_t texel) const;
    /// Returns the light paths of the patch at this texel, or nothing beside all charts.
    std::optional<InspectPaths> paths(uint32_t texel);
    InspectVoxels voxels(uint32_t resolution) const;

private:
    PatchValues nothing() const;
    PatchValues errors() const;
    PatchValues seenFrom(uint32_t texel);
    PatchValues layerOf(const InspectRequest& request) const;
    PatchValues leafColors(const PairSettings& preview);

    Baker& baker_;
    const SolverSettings& settings_;
    PatchInspector inspector_;
};

} // namespace relume
