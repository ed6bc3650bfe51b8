#include "assets/survey/street_view.h"

#include "assets/survey/level_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr float kEyeHeight = 1.7f;    // [m]
constexpr float kElbowRoom = 0.6f;    // [m], around the eye
constexpr size_t kMostPlaces = 400;   // that are looked at
constexpr float kWall = 0.5f;         // the cosine of the angle to the upright of what is no wall any more
constexpr float kStreetReach = 80.0f; // [m], how far walls may be
constexpr float kEnclosed = 0.5f;     // share of all directions that must end at walls: one stands among them
constexpr float kGlance = 0.09f;      // [rad], above the horizon, of the rays that look for walls

// Holds what is seen around an eye: columns go around, rows go up. Both are some 6 degrees apart.
constexpr int kColumns = 64, kRows = 11;
constexpr float kStepUp = 0.1f, kPitch = 0.05f; // [rad]; the pitch of the picture's middle

constexpr int kDepths = 5; // up to 6, 12, 24, 48 m, and beyond

struct Sight {
    float farness = 1.0f; // of what is seen, in steps of depth, from 0 to 1
    int depth = -1;       // of what is not walked on; below 0: that, or the sky
    bool sky = true, near = false;
};
using Panorama = std::array<Sight, static_cast<size_t>(kColumns* kRows)>;

glm::vec3 wayOf(float heading, float pitch) {
    return {std::cos(heading) * std::cos(pitch), std::sin(pitch), std::sin(heading) * std::cos(pitch)};
}

float headingOf(int column) {
    return 2.0f * glm::pi<float>() * static_cast<float>(column) / kColumns;
}

float pitchOf(int row) {
    return kPitch + kStepUp * (static_cast<float>(row) - 0.5f * (kRows - 1));
}

bool standsAmongWalls(const LevelRays& rays, const glm::vec3& eye) {
    constexpr int kEach = 2; // every second column
    int walls = 0;
    for (int column = 0; column < kColumns; column += kEach) {
        const LevelHit hit = rays.trace(eye, wayOf(headingOf(column), kGlance));
        walls += hit.distance <= kStreetReach && std::abs(hit.normal.y) < kWall ? 1 : 0;
    }
    return static_cast<float>(walls) >= kEnclosed * kColumns / kEach;
}

Sight sightOf(const LevelHit& hit, float pitch) {
    if (std::isinf(hit.distance)) return {};
    constexpr float kNear = 2.5f, kFirst = 6.0f; // [m]
    const float steps = std::log2(hit.distance / kFirst);
    Sight sight{.farness = std::clamp(steps / (kDepths - 1), 0.0f, 1.0f), .sky = false};
    if (pitch < 0.0f && std::abs(hit.normal.y) > kWall) return sight; // it is walked on
    sight.depth = std::clamp(static_cast<int>(std::ceil(steps)), 0, kDepths - 1);
    sight.near = hit.distance < kNear;
    return sight;
}

/// Counts what a picture shows, weighed by the angle that it takes.
struct Shown {
    float all = 0.0f, sky = 0.0f, near = 0.0f, ahead = 0.0f, farness = 0.0f;
    std::array<float, kDepths> depths{}; // of what is not walked on

    void add(const Sight& sight, float weight, bool middle) {
        all += weight;
        if (sight.sky) sky += weight;
        if (sight.near) near += weight;
        if (sight.depth >= 0) depths[static_cast<size_t>(sight.depth)] += weight;
        if (!middle) return;
        ahead += weight;
        farness += weight * sight.farness;
    }
    float score() const {
        float things = 0.0f, mix = 0.0f;
        for (const float depth : depths)
            things += depth;
        if (things <= 0.0f || ahead <= 0.0f) return 0.0f;
        for (const float depth : depths)
            if (depth > 0.0f) mix -= depth / things * std::log2(depth / things);
        mix /= std::log2(static_cast<float>(kDepths));
        constexpr float kMostSky = 0.35f, kNearPenalty = 8.0f;
        const float bright = 1.0f - std::max(sky / all - kMostSky, 0.0f);
        return things / all * (0.3f + mix) * (0.5f + farness / ahead) * bright * bright *
               std::exp(-kNearPenalty * near / all);
    }
};

// Takes the best heading of an eye.
void lookAround(const LevelRays& rays, const glm::vec3& eye, float aspect, bool sided,
                std::optional<StandingView>& best) {
    constexpr float kBackShare = 0.05f; // of the rays: of a leaf, a flag, a hole in a mesh
    Panorama panorama;
    int backs = 0;
    for (int i = 0; i < kColumns * kRows; ++i) {
        const float pitch = pitchOf(i / kColumns);
        const LevelHit hit = rays.trace(eye, wayOf(headingOf(i % kColumns), pitch));
        panorama[static_cast<size_t>(i)] = sightOf(hit, pitch);
        backs += !std::isinf(hit.distance) && !hit.front ? 1 : 0;
    }
    if (sided && static_cast<float>(backs) > kBackShare * kColumns * kRows) return;
    const float halfWidth = std::atan(aspect * std::tan(0.5f * kStandingFov));
    const int reach = std::min(static_cast<int>(halfWidth / headingOf(1)), kColumns / 2);
    for (int heading = 0; heading < kColumns; ++heading) {
        Shown shown;
        for (int row = 0; row < kRows; ++row)
            for (int side = -reach; side <= reach; ++side) {
                const int column = (heading + side + kColumns) % kColumns;
                shown.add(panorama[static_cast<size_t>(row * kColumns + column)], std::cos(pitchOf(row)),
                          3 * std::abs(side) <= reach && std::abs(row - kRows / 2) <= 1);
            }
        const float score = shown.score();
        if (score <= (best ? best->score : 0.0f)) continue;
        constexpr float kNearest = 3.0f, kFarthest = 15.0f; // [m], of the target, about which one orbits
        const glm::vec3 way = wayOf(headingOf(heading), kPitch);
        best = {eye, eye + std::clamp(rays.trace(eye, way).distance, kNearest, kFarthest) * way, score};
    }
}

} // namespace

std::optional<StandingView> standingView(const LevelRays& rays, const glm::vec3& low, const glm::vec3& high,
                                         float aspect) {
    const LevelGround ground = findGround(rays, low, high);
    std::optional<StandingView> best;
    const size_t step = ground.places.size() / kMostPlaces + 1;
    for (size_t i = step / 2; i < ground.places.size(); i += step) {
        const glm::vec3 eye = ground.places[i] + glm::vec3(0.0f, kEyeHeight, 0.0f);
        if (rays.clearance(eye) < kElbowRoom || !standsAmongWalls(rays, eye)) continue;
        lookAround(rays, eye, aspect, ground.sided, best);
    }
    return best;
}

} // namespace relume
