#pragma once

#include <optional>
#include <utility>

#include "app/live/live_bake.h"
#include "app/viewer/picture/probe_balls.h"
#include "app/viewer/picture/scene_view.h"
#include "app/viewer/picture/texel_readout.h"

namespace relume {

/// Returns what the bake is to show for a view, or nothing where that is not chosen yet: a light, a patch.
std::optional<InspectRequest> inspectionOf(const ViewState& view, const LightList& lights,
                                           const std::vector<LightGroup>& groups);

/// Asks the bake for what the view shows: which map, links of a patch, voxels, the light of places. It tells
/// the bake which tiles the camera sees.
class Inspection {
public:
    /// Both arguments must outlive it.
    Inspection(LiveBake& bake, SceneView& picture)
        : bake_(bake), picture_(picture), balls_(bake, picture), readout_(picture) {}

    /// Says that a scene came, which may be the former one, `kept` as it was looked at.
    void sceneCame(bool kept) {
        askedBake_ = 0;
        balls_.sceneCame(kept);
        readout_.sceneCame();
    }
    /// Asks for what the view shows now, and takes what was answered. Returns whether the picture changed.
    bool follow(const BakeStatus& status, const LightList& lights, double time);
    ProbeBalls& balls() { return balls_; }
    TexelReadout& readout() { return readout_; }
    /// Returns how many tiles the camera sees, once for each time that the bake was told.
    std::optional<size_t> takeSeen() { return std::exchange(seen_, std::nullopt); }
    /// Tells whether a map is the one that was asked for.
    bool asksFor(const PublishedMap& map) const;

private:
    bool takeAnswers();
    void askBesideMaps(const BakeStatus& status, double time);

    LiveBake& bake_;
    SceneView& picture_;
    ProbeBalls balls_;
    TexelReadout readout_;
    InspectRequest asked_;
    uint64_t askedBake_ = 0; // the bake that was asked for voxels and tiles
    uint32_t askedVoxels_ = 0;
    double tilesAsked_ = -1e9; // [s]
    std::optional<size_t> seen_;
};

} // namespace relume
