#pragma once

#include <optional>
#include <string>
#include <utility>

#include "app/live/live_bake.h"
#include "app/viewer/picture/scene_view.h"

namespace relume {

/// Returns the radius of the ball that a user drags [m]: it is a twentieth of the scene across.
float ballRadius(const Box& bounds);
/// Returns the balls of a picture: the dragged one where it stands now, with the newest light that is known
/// of it, and those of a grid.
std::vector<BallDraw::Ball> ballsToDraw(const std::optional<glm::vec3>& ball, const LitBalls& lit,
                                        const Box& bounds);
/// Returns the distance along a ray at which it meets a ball, or nothing where it misses it [m].
std::optional<float> meetsBall(const ScreenRay& ray, const glm::vec3& centre, float radius);

/// Shows the light of places in a scene: on a ball that a user drags, and on a grid of light probes. Asks the
/// bake for it and draws what it answers.
class ProbeBalls {
public:
    /// Both must outlive it.
    ProbeBalls(LiveBake& bake, SceneView& picture) : bake_(bake), picture_(picture) {}

    /// Says that a scene came; the ball goes with the former one, unless this one was `kept`.
    void sceneCame(bool kept);
    /// Asks for what the view shows now, and takes what was answered. Returns whether the picture changed.
    bool follow();
    /// Returns what the last answer was, for the log of actions; "" where there was none since the last call.
    std::string takeTold() { return std::exchange(told_, {}); }
    /// Returns once why the balls are grey, "" where they are not.
    std::string takeRemark() { return std::exchange(remark_, {}); }

private:
    void draw();

    LiveBake& bake_;
    SceneView& picture_;
    BallRequest asked_;
    LitBalls lit_;
    std::string told_, remark_;
};

} // namespace relume
