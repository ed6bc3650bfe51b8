#include "app/viewer/picture/probe_balls.h"

#include "app/live/light_balls.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace relume {
namespace {

constexpr float kBallShare = 0.025f; // of the scene's diagonal: the ball's radius
constexpr float kGridShare = 0.1f;   // of the least distance in a grid: a radius, which leaves gaps

// Returns the least distance of neighbours in a grid's order, which goes along x, or else along what comes
// next.
float spacingOf(const std::vector<LitBall>& grid, float alone) {
    return grid.size() > 1 ? glm::distance(grid[0].position, grid[1].position) : alone;
}

} // namespace

float ballRadius(const Box& bounds) {
    return bounds.empty() ? 1.0f : std::max(kBallShare * bounds.diagonal(), 1e-6f);
}

std::vector<BallDraw::Ball> ballsToDraw(const std::optional<glm::vec3>& ball, const LitBalls& lit,
                                        const Box& bounds) {
    std::vector<BallDraw::Ball> balls;
    const auto kindOf = [](const LitBall& one) {
        return one.inside ? BallDraw::Kind::Inside : BallDraw::Kind::Lit;
    };
    if (ball) {
        BallDraw::Ball& one = balls.emplace_back();
        one.centre = *ball;
        one.radius = ballRadius(bounds);
        if (lit.ball) {
            one.kind = kindOf(*lit.ball);
            one.lighting = lit.ball->lighting;
        }
    }
    const float radius = kGridShare * spacingOf(lit.grid, 2.0f * ballRadius(bounds));
    for (const LitBall& probe : lit.grid)
        balls.push_back({probe.position, radius, kindOf(probe), probe.lighting});
    return balls;
}

std::optional<float> meetsBall(const ScreenRay& ray, const glm::vec3& centre, float radius) {
    const glm::vec3 way = centre - ray.origin;
    const float along = glm::dot(way, ray.direction);
    const glm::vec3 beside = way - along * ray.direction;
    const float inside = radius * radius - glm::dot(beside, beside);
    if (inside < 0.0f) return std::nullopt;
    const float distance = along - std::sqrt(inside);
    return distance > 0.0f ? std::optional(distance) : std::nullopt;
}

void ProbeBalls::sceneCame(bool kept) {
    if (!kept) {
        picture_.state().ball.reset();
        picture_.state().ballSelected = false;
        lit_ = {};
    }
    draw();
}

bool ProbeBalls::follow() {
    const ViewState& view = picture_.state();
    BallRequest wanted{.ball = view.ball};
    if (view.probes && picture_.pane().hasScene()) wanted.grid = gridOfView(picture_.pane().bounds());
    bool changed = false;
    if (wanted != asked_) {
        if (!wanted.ball) lit_.ball.reset();
        if (wanted.grid != asked_.grid) lit_.grid.clear();
        asked_ = wanted;
        bake_.askBalls(wanted);
        changed = true;
    }
    if (std::optional<LitBalls> answer = bake_.takeBalls()) {
        if (!answer->remark.empty()) remark_ = answer->remark;
        const auto inside = std::count_if(answer->grid.begin(), answer->grid.end(),
                                          [](const LitBall& ball) { return ball.inside; });
        told_ = fmt::format("{}{} in a grid, {} of them inside walls, {}", answer->ball ? "ball, " : "",
                            answer->grid.size(), inside, answer->traced ? "traced" : "light alone");
        if (!answer->remark.empty()) lit_ = {};
        if (wanted.ball.has_value() == answer->ball.has_value()) lit_.ball = answer->ball;
        if (wanted.grid.size() == answer->grid.size()) lit_.grid = std::move(answer->grid);
        changed = true;
    }
    if (changed) draw();
    return changed;
}

void ProbeBalls::draw() {
    const std::vector<BallDraw::Ball> balls =
        ballsToDraw(picture_.state().ball, lit_, picture_.pane().bounds());
    picture_.pane().setBalls(balls.empty() ? nullptr : std::make_unique<BallDraw>(balls));
}

} // namespace relume
