#pragma once

// Here are a bake of layers whose scene is edited, and the room that is baked.
#include "bake/layers/layer_solver.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/light_at.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {

using Light4 = std::vector<glm::vec4>;

inline Light bulbInRoom() {
    Light bulb = lightAt(LightType::Point, {1.5f, 1.5f, 1.5f}, 3.0f, "Bulb");
    bulb.radius = 0.1f;
    return bulb;
}

inline Light spotInRoom() {
    return lightAt(LightType::Spot, {0.4f, 1.2f, 1.8f}, 9.0f, "Spot");
}

inline Light panelInRoom() {
    Light panel = lightAt(LightType::Rectangle, {1.3f, 1.0f, 1.7f}, 20.0f, "Panel");
    panel.size = {0.3f, 0.2f};
    return panel;
}

/// Makes a closed room of 2 m with a plate that shines, a block on the floor, a bulb, a spot and a panel.
inline Scene room(float albedo = 0.6f) {
    SceneMaker maker(64);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(albedo), 16);
    maker.quad({0.6f, 0.6f, 1.9f}, 0.4f * kY, 0.4f * kX, maker.material(0.0f, 8.0f), glm::uvec2(4));
    maker.quad({1.2f, 0.3f, 0.7f}, 0.5f * kX, 0.9f * kY, maker.material(0.3f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.lights = {bulbInRoom(), spotInRoom(), panelInRoom()};
    scene.lights[1].color = {0.2f, 0.5f, 1.0f};
    return scene;
}

inline constexpr BakeDesc kQuick{
    .passes = 0, .method = Method::Hybrid, .samples = 32, .smooth = true, .layers = true};

/// Holds a bake of layers whose scene is edited: the bake follows `scene` when it is told.
class Layered {
public:
    explicit Layered(Scene start, const BakeDesc& desc = kQuick)
        : scene(std::move(start)), baked_(scene), baker_(makeEditableBaker(baked_, desc)) {}

    Baker& baker() { return *baker_; }
    LayerSolver& solver() { return *baker_->layers(); }
    const SolverProgress& progress() { return solver().progress(); }
    void finish() {
        while (!solver().done())
            solver().step();
    }
    /// Has the bake follow the scene at once; with the atlas of its start where objects have moved.
    void editNow(const LightMix& mix = {}, const LightmapAtlas* atlas = nullptr) {
        ASSERT_EQ(apply(mix, atlas), Applied::Now);
    }
    /// Does so when the solver is at rest.
    void edit(const LightMix& mix = {}) {
        while (!solver().atRest())
            solver().step();
        editNow(mix);
    }
    Applied apply(const LightMix& mix = {}, const LightmapAtlas* atlas = nullptr) {
        return baker_->apply({.scene = editsOf(scene), .mix = mix, .atlas = atlas});
    }
    Light4 light() { return solver().light(); }
    Light4 layer(size_t i) { return solver().layerLight(*solver().layers()[i]); }
    const PatchSet& patches() const { return baker_->patches(); }
    FloatImage image() const { return baker_->lightmap({.sew = false}); }

    Scene scene;

private:
    Scene baked_;
    std::unique_ptr<Baker> baker_;
};

inline Light4 freshLight(const Scene& scene, const BakeDesc& desc = kQuick) {
    Layered fresh(scene, desc);
    fresh.finish();
    return fresh.light();
}

inline bool sameBytes(const Light4& a, const Light4& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                              [](const glm::vec4& x, const glm::vec4& y) { return x == y; });
}

inline double meanOf(const Light4& light) {
    double sum = 0;
    for (const glm::vec4& v : light)
        sum += double{v.r} + v.g + v.b;
    return sum / (3.0 * static_cast<double>(light.size()));
}

inline glm::mat4 at(glm::vec3 position) {
    return glm::translate(glm::mat4(1.0f), position);
}

/// Returns the root of the mean squared difference, relative to the mean of b.
inline double distance(const Light4& a, const Light4& b) {
    double squares = 0, sum = 0;
    for (size_t i = 0; i < b.size(); ++i) {
        const glm::vec3 difference = glm::vec3(a[i]) - glm::vec3(b[i]);
        squares += glm::dot(difference, difference);
        sum += b[i].r + b[i].g + b[i].b;
    }
    return std::sqrt(squares / (3.0 * static_cast<double>(b.size()))) /
           (sum / (3.0 * static_cast<double>(b.size())));
}

} // namespace relume
