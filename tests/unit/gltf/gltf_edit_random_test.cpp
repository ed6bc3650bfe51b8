// After random edits of random files, what is read back is what was saved, however often.
#include "assets/gltf/edit/gltf_edit.h"
#include "tests/unit/edited_file.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace relume {
namespace {

using nlohmann::json;

class GltfEditRandom : public test::EditedFile {
protected:
    float number(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
    int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

    /// Returns a rigid transform, so that no parent shears what is below it.
    glm::mat4 pose() {
        const glm::mat4 place = glm::translate(glm::mat4(1), {number(-5, 5), number(-5, 5), number(-5, 5)});
        return glm::rotate(place, number(-3, 3), glm::vec3(number(-1, 1), 1, number(-1, 1)));
    }

    /// Makes a tree of nodes with lights of all kinds, some of which share an entry.
    test::LitScene file() {
        test::LitScene scene;
        scene.json["materials"] =
            json::array({{{"name", "A"}}, {{"name", "B"}, {"emissiveFactor", {1, 0.5, 0.2}}}});
        scene.json["meshes"][0]["primitives"][0]["material"] = pick(2);
        scene.light({{"type", "point"}, {"name", "P"}, {"intensity", 40}});
        scene.light({{"type", "spot"}, {"color", {1, 0.5, 0.1}}, {"spot", {{"outerConeAngle", 0.9}}}});
        scene.light({{"type", "directional"}, {"extras", {{"relume", {{"angle", 0.01}}}}}});
        for (int nodes = pick(8); nodes > 0; --nodes) {
            json node = {{"translation", {number(-2, 2), 1, 0.5}}};
            if (pick(2) == 0) node["rotation"] = {0, 0.6, 0, 0.8};
            if (pick(3) == 0) node["mesh"] = scene.json["nodes"][0]["mesh"];
            if (pick(2) == 0) node["extensions"]["KHR_lights_punctual"]["light"] = pick(3);
            if (pick(4) == 0) node["extras"]["relume"]["areaLight"] = {{"type", "disc"}, {"radius", 0.3}};
            const int index = scene.node(node), parent = pick(index + 1) - 1;
            json& holder =
                parent < 0 ? scene.json["scenes"][0]["nodes"] : scene.json["nodes"][parent]["children"];
            holder.push_back(index);
        }
        return scene;
    }

    void edit(Scene& scene) {
        std::vector<Light>& lights = scene.lights;
        const auto some = [&]() -> Light& { return lights[static_cast<size_t>(pick(int(lights.size())))]; };
        for (int edits = 1 + pick(4); edits > 0; --edits) {
            const int kind = lights.empty() ? 5 + pick(4) : pick(9);
            if (kind == 0) some().intensity = number(0, 1000);
            if (kind == 1) some().color = {number(0, 1), 1, number(0, 1)};
            if (kind == 2) some().transform = pose();
            if (kind == 3) lights.erase(lights.begin() + pick(int(lights.size())));
            if (kind == 4) {
                Light& light = some();
                light.type = static_cast<LightType>(pick(5));
                light.radius = 0.2f;
            }
            if (kind == 5) {
                Light& light = *lights.emplace(lights.begin() + pick(int(lights.size()) + 1));
                light.type = static_cast<LightType>(pick(5));
                light.transform = pose();
                light.radius = 0.2f;
            }
            if (kind == 6)
                scene.instances[static_cast<size_t>(pick(int(scene.instances.size())))].transform = pose();
            if (kind == 7)
                scene.materials[static_cast<size_t>(pick(2))].emission =
                    glm::vec3(number(0, 1), 2, 3) * number(0, 100);
            if (kind == 8) scene.sky.radiance = {number(0, 3), number(0, 3), float(pick(2))};
        }
    }

    static bool isArea(const Light& light) {
        return light.type == LightType::Rectangle || light.type == LightType::Disc;
    }

    static void expectSame(const Scene& saved, const Scene& back) {
        ASSERT_EQ(back.lights.size(), saved.lights.size());
        for (const Light& light : saved.lights) {
            const auto found = std::find_if(back.lights.begin(), back.lights.end(), [&](const Light& other) {
                return other.node == light.node && isArea(other) == isArea(light);
            });
            ASSERT_NE(found, back.lights.end());
            EXPECT_EQ(found->type, light.type);
            EXPECT_EQ(found->intensity, light.intensity);
            EXPECT_EQ(found->color, light.color);
            test::expectNear(found->transform, light.transform, 1e-4f);
        }
        for (const Instance& instance : saved.instances)
            for (const Instance& other : back.instances)
                if (other.node == instance.node) test::expectNear(other.transform, instance.transform, 1e-4f);
        for (size_t i = 0; i < saved.materials.size(); ++i)
            EXPECT_EQ(back.materials[i].emission, saved.materials[i].emission);
        EXPECT_EQ(back.sky.radiance, saved.sky.radiance);
    }

    std::mt19937 random_;
};

TEST_F(GltfEditRandom, WhatWasSavedIsReadBack) {
    constexpr uint32_t kFiles = 60, kSaves = 6;
    for (uint32_t seed = 0; seed < kFiles && !HasFailure(); ++seed) {
        SCOPED_TRACE(seed);
        random_.seed(seed);
        const std::string path = write(file());
        Scene held = loadGltf(path);
        for (uint32_t i = 0; i < kSaves; ++i) {
            if (i % 2 == 0) held = loadGltf(path); // else what the last save told is built upon
            Scene next = held;
            edit(next);
            const EditedNodes nodes = saveEditedGltf(path, held, next, path);
            for (size_t l = 0; l < next.lights.size(); ++l)
                next.lights[l].node = nodes.lights[l];
            for (size_t o = 0; o < next.instances.size(); ++o)
                next.instances[o].node = nodes.instances[o];
            expectSame(next, loadGltf(path));
            held = next;
        }
    }
}

} // namespace
} // namespace relume
