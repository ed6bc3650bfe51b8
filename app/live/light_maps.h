#pragma once

#include <memory>
#include <vector>

#include "app/live/map_decision.h"
#include "bake/show/publisher.h"
#include "bake/solver/solver.h"

namespace relume {

/// The publisher that maps are drawn with, and what goes with each of them.
struct MapSource {
    std::unique_ptr<Publisher> publisher;
    uint64_t bake = 0;                    // its number
    bool radiance = false, filled = true; // as PublishedMap has them
};

/// Keeps a bake's light as texels: the light of the bake before is there until the new one has light to show
/// in its place. Only the bake thread uses it.
class LightMaps {
public:
    /// Begins with a bake; `kept` says how long the light before stays.
    void begin(MapSource source, KeptLight kept);
    /// Says that the same bake goes on with another number, as its lights or surfaces were edited.
    void edited(uint64_t number, const PatchSet& patches);
    /// Ends the bake. Its texels stay if they were drawn.
    void end();

    /// Asks the solver for its light and takes note of what has changed. decide() and draw() are told what it
    /// answers. `current` says whether that light is of the newest edit.
    LiveLight ask(Solver& solver, bool current);
    /// Decides on the next map, where the newest one shows something else or not.
    LightMapStep decide(const LiveLight& live, bool otherOnScreen) const;
    /// Returns the edge of the lightmap that such a step shows [texels].
    uint32_t size(LightMapStep step) const;
    /// Tells whether the light that was drawn is of the newest edit.
    bool current() const { return drawnCurrent_; }
    /// Draws the solver's light, where the step says so, and returns what the map is of.
    MapSource& draw(LightMapStep step, const LiveLight& live);

private:
    MapSource light_, next_;           // next_ takes light_'s place once there is a solution
    KeptLight kept_ = KeptLight::None; // while next_ waits
    std::vector<ChunkRange> changed_;  // since light_'s or next_'s last update
    uint64_t drawnVersion_ = 0;        // of the solver's light that light_ holds; 0: none of this bake
    bool current_ = false;             // the solver's light is of the newest edit
    bool drawnCurrent_ = false;        // light_ was, when it was drawn
    bool edited_ = false;              // since the newest map
};

} // namespace relume
