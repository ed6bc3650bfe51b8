#pragma once

#include <optional>
#include <vector>

#include "app/live/live_bake.h"
#include "app/viewer/picture/light_previews.h"
#include "app/viewer/picture/scene_view.h"

namespace relume {

/// Keeps the previews of lights up to date while they are on screen: asks which surfaces the resting camera
/// sees, asks the bake for their light, and has the pictures drawn. Nothing is done while nobody sees them.
class PreviewUpdates {
public:
    /// All that it is given must outlive it.
    PreviewUpdates(const Session& session, LiveBake& bake, SceneView& picture)
        : session_(session), bake_(bake), picture_(picture) {}

    LightPreviews& previews() { return previews_; }
    /// Says that another scene came.
    void sceneCame();
    /// Does what is due. `held` says that the mouse moves something. Returns whether a preview was drawn.
    bool follow(const std::vector<LightSource>& lights, const std::vector<LightGroup>& groups, bool held,
                double time);
    /// Tells whether something is under way: call follow() again soon.
    bool underWay() const;

private:
    /// The state of the scene that the previews show.
    struct Shown {
        ViewCamera camera;
        uint64_t scene = 0; // its number
        std::vector<Placement> placements;
        uint32_t size = 0; // of the lightmap

        bool operator==(const Shown&) const = default;
    };

    const Session& session_;
    LiveBake& bake_;
    SceneView& picture_;
    LightPreviews previews_;
    std::optional<Shown> shown_; // none: nothing is asked for
    bool due_ = false;           // some may still have to be drawn
};

} // namespace relume
