#include "app/bench/lamp_placement.h"

#include "assets/base/error.h"
#include "bake/trace/embree_scene.h"
#include "renderer/scene_geometry.h"

#include <algorithm>
#include <array>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

using shader::kChunk;

constexpr std::array<uint32_t, 3> kBases = {2, 3, 5}; // of the Halton sequence, for x, y, z
constexpr uint32_t kMostPoints = 8192;                // of it, after which no place is left
constexpr uint32_t kRays = 32;                        // of each hemisphere of a place, upper and lower
constexpr uint32_t kPlacesAtOnce = kChunk / 2;        // a receiver for each hemisphere
// These are shares of all rays: enough must meet fronts, be it only the floor of an open scene; backs mean
// that the place is inside something, but for a few seen through gaps.
constexpr float kLeastFronts = 0.25f, kMostBacks = 0.1f;
// Lamps are at least this share of the diagonal from surfaces: nearer ones would light one spot and nothing
// else.
constexpr float kClearance = 0.02f;
constexpr float kMove = 0.1f;        // of the diagonal
constexpr float kRadius = 0.005f;    // of the diagonal: soft shadows, but of small lamps
constexpr float kLightReach = 0.25f; // of the diagonal: where a lamp's light is 1

// Returns the digits of index mirrored at the point, in [0, 1) [Halton 1964].
float radicalInverse(uint32_t base, uint32_t index) {
    double result = 0, digit = 1.0 / base;
    for (; index > 0; index /= base, digit /= base)
        result += digit * (index % base);
    return static_cast<float>(result);
}

glm::vec3 pointOf(const Box& bounds, uint32_t index) {
    glm::vec3 p;
    for (int k = 0; k < 3; ++k)
        p[k] = radicalInverse(kBases[static_cast<size_t>(k)], index);
    return bounds.low + p * bounds.size();
}

/// Looks around from points in space, as patches there would.
class Lookout {
public:
    Lookout(const TraceScene& scene, const Box& bounds)
        : scene_(scene), embree_(scene, pool_), diagonal_(bounds.diagonal()) {}

    /// Tells which of the positions, at most kPlacesAtOnce, see surfaces.
    std::vector<bool> seeSurfaces(const std::vector<glm::vec3>& places) {
        std::vector<shader::Patch> eyes(kChunk, shader::Patch{});
        for (size_t i = 0; i < places.size(); ++i) {
            for (const uint32_t lower : {0u, 1u}) {
                shader::Patch& eye = eyes[2 * i + lower];
                eye.position = places[i];
                eye.normal = eye.shading = {0.0f, lower != 0 ? -1.0f : 1.0f, 0.0f};
                eye.flags = shader::kPatchSends | static_cast<uint32_t>(2 * i + lower) << shader::kTexelShift;
            }
        }
        std::vector<uint32_t> links(size_t{kChunk} * kRays);
        embree_.closest(
            {.receivers = eyes.data(), .chunkCount = 1, .sampleCount = kRays, .links = links.data()});
        std::vector<bool> result;
        for (size_t i = 0; i < places.size(); ++i)
            result.push_back(seesSurfaces(places[i], links, 2 * i));
        return result;
    }

private:
    bool seesSurfaces(const glm::vec3& place, const std::vector<uint32_t>& links, size_t eye) const {
        uint32_t fronts = 0, backs = 0;
        for (uint32_t k = 0; k < 2 * kRays; ++k) {
            const uint32_t link = links[k / 2 * kChunk + eye + k % 2];
            backs += link == shader::kLinkBack;
            if (link >= shader::kLinkFirstSpecial) continue;
            if (glm::distance(place, scene_.patches[link].position) < kClearance * diagonal_) return false;
            ++fronts;
        }
        return static_cast<float>(fronts) >= kLeastFronts * 2 * kRays &&
               static_cast<float>(backs) <= kMostBacks * 2 * kRays;
    }

    const TraceScene& scene_;
    WorkerPool pool_{0}; // it has no device, whose pool it could share
    EmbreeScene embree_;
    float diagonal_;
};

} // namespace

LampPlaces placeLamps(const TraceScene& scene, uint32_t count) {
    const Box bounds = boundsOf(scene.mesh);
    LampPlaces result;
    result.diagonal = bounds.diagonal();
    const auto movedFrom = [&](const glm::vec3& place) {
        const glm::vec3 way = bounds.centre() - place;
        const float length = glm::length(way);
        return length > 0.0f ? place + kMove * result.diagonal / length * way : place;
    };
    Lookout lookout(scene, bounds);
    for (uint32_t first = 1; first <= kMostPoints; first += kPlacesAtOnce) {
        std::vector<glm::vec3> places, moved;
        for (uint32_t i = 0; i < kPlacesAtOnce; ++i) {
            places.push_back(pointOf(bounds, first + i));
            moved.push_back(movedFrom(places.back()));
        }
        const std::vector<bool> good = lookout.seeSurfaces(places), goodMoved = lookout.seeSurfaces(moved);
        for (size_t i = 0; i < places.size(); ++i) {
            if (!good[i] || (result.positions.empty() && !goodMoved[i])) continue;
            if (result.positions.empty()) result.moved = moved[i];
            result.positions.push_back(places[i]);
            if (result.positions.size() == count) return result;
        }
    }
    throw Error("the scene has no free places for " + std::to_string(count) +
                " lamps that see its surfaces: ask for fewer by --lights");
}

Light lampAt(const LampPlaces& places, uint32_t index) {
    const float reach = kLightReach * places.diagonal;
    Light lamp;
    lamp.name = "bench lamp " + std::to_string(index + 1);
    lamp.transform = glm::translate(glm::mat4(1.0f), places.positions[index]);
    lamp.intensity = glm::pi<float>() * reach * reach;
    lamp.radius = kRadius * places.diagonal;
    return lamp;
}

const char* lampPlacementText() {
    return "white spheres of 0.5 % of the diagonal in radius at points of the Halton sequence (2, 3, 5) in "
           "the "
           "scene's bounds that see surfaces, each of 1 cd/m^2 on white at a quarter of the diagonal; the "
           "first one is moved by 10 % of the diagonal towards the middle";
}

} // namespace relume
