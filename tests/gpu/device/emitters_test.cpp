// Picks and form factors of mesh lights on the device are those of the host.
#include "bake/lights/emitters.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"
#include "shaders/shader_compiler.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/unit/emitter_scene.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace relume {
namespace {

const char* const kKernel = R"(#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
#include "lib/form_factor.glsl"
#include "lib/rays/start_point.glsl"
#include "lib/light/texel_mean.glsl"
#include "lib/light/polygon_sample.glsl"
#include "lib/light/emitters.glsl"
layout(push_constant, scalar) uniform Push { ADDRESS nodes, polygons, receivers, result; } push;
EmitterNode emitterNode(uint index) { return loadEmitterNode(push.nodes, index); }
EmitterPolygon emitterPolygon(uint index) { return loadEmitterPolygon(push.polygons, index); }
#include "lib/light/pick_emitter.glsl"
layout(local_size_x = 64) in;
void main() {
    uint i = gl_GlobalInvocationID.x;
    vec4 p = Vec4s(push.receivers).items[2u * i], n = Vec4s(push.receivers).items[2u * i + 1u];
    float probability;
    uint picked;
    if (i % 2u == 0u) {
        picked = pickEmitter(p.xyz, n.xyz, p.w, probability);
    } else {
        PickView view = pointView(p.xyz, n.xyz);
        picked = pickNearEmitter(view, p.w, probability);
    }
    vec4 result = vec4(uintBitsToFloat(picked), probability, 0.0, 0.0);
    if (picked != kNoEmitter) {
        EmitterPolygon e = loadEmitterPolygon(push.polygons, picked);
        result.z = emitterFormFactor(p.xyz, n.xyz, e);
        result.w = emitterPointFactor(p.xyz, n.xyz, e, emitterPoint(e, vec2(n.w, p.w)));
    }
    Vec4s(push.result).items[i] = result;
}
)";

struct Push {
    VkDeviceAddress nodes, polygons, receivers, result;
};

} // namespace

TEST(Emitters, AreSampledOnTheDeviceAsOnTheHost) {
    const vk::Device& device = testDevice();
    Scene scene = test::manyLamps(300, 0.1f);
    for (size_t i = 0; i < scene.meshes.size(); i += 3) // every third a triangle
        scene.meshes[i].primitives[0].indices.resize(3);
    const EmitterSet set = test::emittersOf(scene);
    constexpr uint32_t count = 4096;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<glm::vec4> receivers; // position, u; normal, v
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 p(unit(random), unit(random), unit(random));
        receivers.emplace_back(p, unit(random));
        const glm::vec3 n(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f);
        receivers.emplace_back(glm::normalize(n), unit(random));
    }
    const vk::Buffer nodes = vk::makeBuffer(device, set.nodes, "nodes");
    const vk::Buffer polygons = vk::makeBuffer(device, set.polygons, "polygons");
    const vk::Buffer input = vk::makeBuffer(device, receivers, "receivers");
    const vk::Buffer output(device, {.size = count * sizeof(glm::vec4), .name = "picks"});
    const std::vector<uint32_t> code = compileShader({.name = "emitters.comp",
                                                      .text = kKernel,
                                                      .definitions = {},
                                                      .includeFolder = RELUME_SOURCE_DIR "/shaders"});
    const vk::ComputeProgram program(device, code, "emitters");
    vk::Commands commands(device);
    program.dispatch(commands.begin(),
                     Push{nodes.address(), polygons.address(), input.address(), output.address()},
                     count / 64);
    commands.run();
    const std::vector<glm::vec4> found = vk::readBuffer<glm::vec4>(device, output, count);

    shader::EmitterTables tables{&set};
    uint32_t unlike = 0, shining = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 p(receivers[2 * i]), n(receivers[2 * i + 1]);
        const glm::vec2 u(receivers[2 * i + 1].w, receivers[2 * i].w);
        float probability = 0;
        const uint32_t picked = i % 2 == 0 ? tables.pickEmitter(p, n, u.y, probability)
                                           : tables.pickNearEmitter(tables.pointView(p, n), u.y, probability);
        if (picked != std::bit_cast<uint32_t>(found[i].x)) { // u on the border between two
            ++unlike;
            continue;
        }
        EXPECT_NEAR(found[i].y, probability, 1e-4f * probability);
        if (picked == shader::kNoEmitter) continue;
        const shader::EmitterPolygon& e = set.polygons[picked];
        const float factor = shader::emitterFormFactor(p, n, e);
        EXPECT_NEAR(found[i].z, factor, 1e-5f + 1e-4f * factor);
        const float point = shader::emitterPointFactor(p, n, e, shader::emitterPoint(e, u));
        EXPECT_NEAR(found[i].w, point, 1e-5f + 1e-3f * point);
        shining += factor > 0;
    }
    EXPECT_LE(unlike, count / 500);
    EXPECT_GT(shining, count / 3);
}

} // namespace relume
