// The voxel tracer is held against the bvh's, which sees triangles: how often they disagree, in which
// direction, and whether what it calls a hit lies near the real one.
#include "assets/generate/generate.h"
#include "bake/pairs/pair_passes.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"
#include "bake/vk/commands.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace relume {
namespace {

using shader::kBlockWords;
using shader::kChunk;
using shader::kSuper;
using shader::kSuperBlocks;

constexpr uint32_t kVoxelLinkSamples = 8;

/// Runs tracers on some pairs and directions of a scene.
class Questions {
public:
    Questions(const Scene& scene, uint32_t size, uint32_t units)
        : baker_(makeBaker(scene, {.size = size})), chunks_(baker_->patches().chunkCount()),
          commands_(testDevice()) {
        const uint32_t rows = (chunks_ + kSuper - 1) / kSuper;
        std::vector<uint32_t> written;
        for (uint32_t row = 0; row < rows; ++row)
            for (uint32_t column = row; column < rows; ++column)
                supers_.push_back({row, column, 0, {}, {}, 0});
        for (uint32_t unit = 0; unit < supers_.size() * kSuperBlocks; ++unit) {
            const auto [row, column] = chunksOf(unit);
            if (column < chunks_ && row <= column) written.push_back(unit);
        }
        const size_t kept = std::min<size_t>(units, written.size());
        for (size_t i = 0; i < kept; ++i)
            units_.push_back(written[i * written.size() / kept]);
    }

    const PatchSet& patches() const { return baker_->patches(); }
    const shader::Patch& patch(uint32_t index) const { return patches().scene.patches[index]; }
    std::unique_ptr<Tracer> tracer(TracerKind kind, const VoxelSettings& voxels = {}) {
        return makeTracer(kind, testDevice(), patches().scene, baker_->light().patches, voxels);
    }

    /// Returns the bits of the kept units, one after the other.
    std::vector<uint32_t> pairs(Tracer& tracer) {
        const vk::Buffer sends =
            vk::makeBuffer(testDevice(), std::vector<uint32_t>(chunks_, 1u), "chunk sends");
        const vk::Buffer rays =
            vk::makeBuffer(testDevice(), std::vector<uint32_t>(2 * shader::kRayCounters, 0u), "ray counters");
        const vk::Buffer bits(testDevice(),
                              {.size = superBytes(false), .memory = vk::Memory::Host, .name = "bits"});
        std::vector<uint32_t> all;
        for (uint32_t unit : units_) {
            std::vector<SuperBlock> table = {supers_[unit / kSuperBlocks]};
            table[0].bits = bits.address();
            const vk::Buffer supers = vk::makeBuffer(testDevice(), table, "super-blocks");
            const std::vector<uint32_t*> host = {static_cast<uint32_t*>(bits.mapped())};
            VkCommandBuffer cmd = commands_.begin();
            tracer.occlusion(cmd, {.supers = table,
                                   .superBuffer = &supers,
                                   .bits = host,
                                   .firstUnit = unit % kSuperBlocks,
                                   .unitCount = 1,
                                   .sends = &sends,
                                   .rays = &rays});
            vk::hostBarrier(cmd);
            commands_.run();
            const uint32_t* words = host[0] + unit % kSuperBlocks * kBlockWords;
            all.insert(all.end(), words, words + kBlockWords);
        }
        return all;
    }

    /// Calls f(row patch, column patch, bit of words) for all facing pairs of the kept units.
    template<typename F>
    void forPairs(const F& f) const {
        for (size_t u = 0; u < units_.size(); ++u) {
            const auto [row, column] = chunksOf(units_[u]);
            for (uint32_t i = 0; i < kChunk; ++i)
                for (uint32_t j = 0; j < kChunk; ++j) {
                    const uint32_t a = row * kChunk + i, b = column * kChunk + j;
                    if (a >= b || !shader::pairFaces(patch(a), patch(b))) continue;
                    f(a, b, (u * kBlockWords + i * 2 + j / 32) * 32 + j % 32);
                }
        }
    }

    /// Returns the links of all patches, as ClosestWork has them.
    std::vector<uint32_t> links(Tracer& tracer) {
        const vk::Buffer buffer(testDevice(), {.size = VkDeviceSize{kVoxelLinkSamples} * kChunk * 4,
                                               .memory = vk::Memory::Host,
                                               .name = "links"});
        std::vector<uint32_t> all;
        for (uint32_t chunk = 0; chunk < chunks_; ++chunk) {
            VkCommandBuffer cmd = commands_.begin();
            tracer.closest(cmd, {.firstChunk = chunk,
                                 .chunkCount = 1,
                                 .firstSample = 0,
                                 .sampleCount = kVoxelLinkSamples,
                                 .links = &buffer});
            vk::hostBarrier(cmd);
            commands_.run();
            const auto* values = static_cast<const uint32_t*>(buffer.mapped());
            all.insert(all.end(), values, values + kVoxelLinkSamples * kChunk);
        }
        return all;
    }

    /// Returns one word of every patch: bit s is set if it sees targets[s].
    std::vector<uint32_t> seen(Tracer& tracer, const std::vector<glm::vec3>& targets) {
        std::vector<glm::vec4> all;
        for (uint32_t chunk = 0; chunk < chunks_; ++chunk)
            for (const glm::vec3& target : targets)
                all.insert(all.end(), kChunk, glm::vec4(target, 1.0f));
        const vk::Buffer ends = vk::makeBuffer(testDevice(), all, "targets");
        const vk::Buffer bits(testDevice(), {.size = VkDeviceSize{chunks_} * kChunk * 4, .name = "bits"});
        const vk::Buffer rays =
            vk::makeBuffer(testDevice(), std::vector<uint32_t>(shader::kRayCounters, 0u), "ray counters");
        VkCommandBuffer cmd = commands_.begin();
        tracer.segments(cmd, {.firstChunk = 0,
                              .chunkCount = chunks_,
                              .targetCount = static_cast<uint32_t>(targets.size()),
                              .targets = &ends,
                              .bits = &bits,
                              .rays = &rays});
        vk::hostBarrier(cmd);
        commands_.run();
        return vk::readBuffer<uint32_t>(testDevice(), bits, size_t{chunks_} * kChunk);
    }

private:
    std::pair<uint32_t, uint32_t> chunksOf(uint32_t unit) const {
        const SuperBlock super = supers_[unit / kSuperBlocks];
        return {super.row * kSuper + unit % kSuperBlocks / kSuper, super.column * kSuper + unit % kSuper};
    }

    std::unique_ptr<Baker> baker_;
    uint32_t chunks_;
    vk::Commands commands_;
    std::vector<SuperBlock> supers_;
    std::vector<uint32_t> units_;
};

bool bitOf(const std::vector<uint32_t>& words, size_t bit) {
    return (words[bit / 32] >> bit % 32 & 1u) != 0;
}

/// Holds shares of all facing pairs, plain and weighted by what their form factor would carry.
struct Disagreement {
    double leaks = 0, falseShadows = 0;               // of the pairs
    double leakedLight = 0, lostLight = 0;            // of the light
    double nearLinks = 0, sky = 0, back = 0, far = 0; // of the links
};

Disagreement compare(Questions& questions, uint32_t resolution) {
    const auto exact = questions.tracer(TracerKind::Bvh);
    const auto voxel = questions.tracer(TracerKind::Voxel, {.resolution = resolution});
    const auto a = questions.pairs(*exact), b = questions.pairs(*voxel);
    Disagreement d;
    double pairs = 0, light = 0;
    questions.forPairs([&](uint32_t i, uint32_t j, size_t bit) {
        const shader::Patch &p = questions.patch(i), &q = questions.patch(j);
        const glm::vec3 way = q.position - p.position;
        const double r2 = glm::dot(way, way);
        const double factor = double(glm::dot(way, p.normal)) * -glm::dot(way, q.normal) * q.area /
                              (r2 * (3.14159265 * r2 + q.area));
        const bool sees = bitOf(a, bit), voxelSees = bitOf(b, bit);
        pairs += 1;
        light += sees ? factor : 0;
        d.leaks += !sees && voxelSees;
        d.falseShadows += sees && !voxelSees;
        d.leakedLight += !sees && voxelSees ? factor : 0;
        d.lostLight += sees && !voxelSees ? factor : 0;
    });
    d.leaks /= pairs, d.falseShadows /= pairs, d.leakedLight /= light, d.lostLight /= light;
    const auto x = questions.links(*exact), y = questions.links(*voxel);
    float voxelSize = 0;
    for (int axis = 0; axis < 3; ++axis) {
        float lo = 1e30f, hi = -1e30f;
        for (const glm::vec3& p : questions.patches().scene.mesh.positions)
            lo = std::min(lo, p[axis]), hi = std::max(hi, p[axis]);
        voxelSize = std::max(voxelSize, (hi - lo) / float(resolution - 1));
    }
    double count = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i] >= shader::kLinkFirstSpecial) continue;
        count += 1;
        d.sky += y[i] == shader::kLinkSky;
        d.back += y[i] == shader::kLinkBack || y[i] == shader::kLinkDark;
        if (y[i] >= shader::kLinkFirstSpecial) continue;
        const float distance = glm::distance(questions.patch(x[i]).position, questions.patch(y[i]).position);
        (distance <= std::max(3 * voxelSize, 2 * std::sqrt(questions.patch(x[i]).area)) ? d.nearLinks
                                                                                        : d.far) += 1;
    }
    d.nearLinks /= count, d.far /= count, d.sky /= count, d.back /= count;
    return d;
}

struct VoxelCase {
    const char* scene;
    uint32_t resolution;
    double falseShadows; // at most this share of the pairs
};
class VoxelAgreement : public testing::TestWithParam<VoxelCase> {};

TEST_P(VoxelAgreement, withTheBvh) {
    const VoxelCase& c = GetParam();
    Questions questions(generateScene(c.scene), 128, 512);
    const Disagreement d = compare(questions, c.resolution);
    RecordProperty("leaks", std::to_string(d.leaks));
    RecordProperty("falseShadows", std::to_string(d.falseShadows));
    RecordProperty("nearLinks", std::to_string(d.nearLinks));
    EXPECT_LE(d.leaks, 0.02);
    EXPECT_LE(d.falseShadows, c.falseShadows);
    EXPECT_LE(d.leakedLight, 0.025);
    EXPECT_GE(d.nearLinks, 0.85);
    EXPECT_LE(d.sky + d.back, 0.03);
    EXPECT_GT(d.falseShadows, 0.001); // voxels were asked at all
}

// These bounds are about one and a half times what was measured; shadows grow by up to a voxel all around.
INSTANTIATE_TEST_SUITE_P(Scenes, VoxelAgreement,
                         testing::Values(VoxelCase{"cornell_geom", 64, 0.11},
                                         VoxelCase{"cornell_geom", 256, 0.03},
                                         VoxelCase{"cornell_statue", 128, 0.04},
                                         VoxelCase{"cornell_layers", 128, 0.02},
                                         VoxelCase{"gallery", 128, 0.06}, VoxelCase{"octagon", 128, 0.10}));

/// Makes a closed room with a plate half-way up, of a fourth of the floor's area.
struct PlateRoom {
    SceneMaker maker{48};
    static constexpr float kPlate = 1.0f, kHeight = 1.01f; // [m], its edge and where it hangs

    PlateRoom() {
        const int white = maker.material(0.5f), lamp = maker.material(0.0f, 5.0f);
        std::array<glm::uvec2, 6> texels;
        texels.fill(glm::uvec2(12));
        maker.box(glm::vec3(-1, -1, 0), {glm::vec3(2, 0, 0), glm::vec3(0, 2, 0), glm::vec3(0, 0, 2)},
                  {white, white, white, white, white, lamp}, texels);
        maker.blocker({-kPlate / 2, -kPlate / 2, kHeight}, {kPlate, 0, 0}, {0, kPlate, 0}, white);
    }
};

/// Returns how far inside the plate's edge the segment passes it [m]; negative: outside. It is only for
/// segments that cross its height.
float insidePlate(glm::vec3 from, glm::vec3 to) {
    const glm::vec3 p = glm::mix(from, to, (PlateRoom::kHeight - from.z) / (to.z - from.z));
    return PlateRoom::kPlate / 2 - std::max(std::abs(p.x), std::abs(p.y));
}

TEST(VoxelTracer, plateBlocksWhatItStandsBetween) {
    PlateRoom room;
    Questions questions(room.maker.scene(), room.maker.size(), 1024);
    constexpr float kVoxel = 2.0f / 63.0f; // [m]
    const auto bits = questions.pairs(*questions.tracer(TracerKind::Voxel, {.resolution = 64}));
    uint32_t blocked = 0, open = 0;
    questions.forPairs([&](uint32_t i, uint32_t j, size_t bit) {
        const glm::vec3 a = questions.patch(i).position, b = questions.patch(j).position;
        if (std::abs(a.z - b.z) < 1.99f) return; // floor to ceiling
        const float inside = insidePlate(a, b);
        if (std::abs(inside) < 3 * kVoxel) return;
        ++(inside > 0 ? blocked : open);
        EXPECT_EQ(bitOf(bits, bit), inside < 0) << i << " and " << j;
    });
    EXPECT_GT(blocked, 1000u);
    EXPECT_GT(open, 1000u);
}

TEST(VoxelTracer, segmentsEndAtThePlate) {
    PlateRoom room;
    Questions questions(room.maker.scene(), room.maker.size(), 1);
    const glm::vec3 lamp(0.3f, 0.2f, 1.99f);
    constexpr float kVoxel = 2.0f / 63.0f; // [m]
    const auto seen =
        questions.seen(*questions.tracer(TracerKind::Voxel, {.resolution = 64}), std::vector{lamp});
    uint32_t blocked = 0, open = 0;
    for (uint32_t i = 0; i < questions.patches().count; ++i) {
        const glm::vec3 p = questions.patch(i).position;
        if (p.z > 0.01f) continue; // the floor's only
        const float inside = insidePlate(p, lamp);
        if (std::abs(inside) < 3 * kVoxel) continue;
        ++(inside > 0 ? blocked : open);
        EXPECT_EQ(seen[i] != 0, inside < 0) << i;
    }
    EXPECT_GT(blocked, 20u);
    EXPECT_GT(open, 10u);
}

// In an empty room every ray ends on a wall that faces it, where the ray meets it.
TEST(VoxelTracer, linksInABoxAreThePatchesThere) {
    SceneMaker maker(64);
    const int white = maker.material(0.5f);
    maker.box(glm::vec3(-1), {glm::vec3(2, 0, 0), glm::vec3(0, 2, 0), glm::vec3(0, 0, 2)}, white, 20);
    Questions questions(maker.scene(), maker.size(), 1);
    constexpr float kReach = 2.0f / 20 + 3 * 2.0f / 99; // [m], a texel and three voxels
    const auto links = questions.links(*questions.tracer(TracerKind::Voxel, {.resolution = 100}));
    for (uint32_t i = 0; i < questions.patches().count; ++i) {
        const shader::Patch& p = questions.patch(i);
        for (uint32_t k = 0; k < kVoxelLinkSamples; ++k) {
            const uint32_t link = links[(i / kChunk * kVoxelLinkSamples + k) * kChunk + i % kChunk];
            ASSERT_LT(link, questions.patches().count) << "patch " << i << ", sample " << k;
            const uint32_t key = shader::rotationKey(p, p, shader::kRotatePatch, maker.size());
            const glm::vec3 d = shader::patchDirection(p, key, k);
            float t = 1e30f;
            for (int axis = 0; axis < 3; ++axis)
                if (d[axis] != 0) t = std::min(t, ((d[axis] > 0 ? 1 : -1) - p.position[axis]) / d[axis]);
            const glm::vec3 off = questions.patch(link).position - (p.position + t * d);
            // At grazing incidence a voxel spans more of the ray.
            const float slant = 1 / -glm::dot(d, questions.patch(link).normal);
            EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), kReach * slant) << i;
        }
    }
}

// Every bit and link of a mixture is one tracer's or the other's, by the sender's texel or the sample.
TEST(MixedTracer, everyPartIsItsTracers) {
    PlateRoom room;
    Questions questions(room.maker.scene(), room.maker.size(), 1024);
    constexpr uint32_t kRatio = 3;
    const VoxelSettings settings{.resolution = 32, .ratio = kRatio};
    const auto exact = questions.tracer(TracerKind::Bvh), mixed = questions.tracer(TracerKind::Bvh, settings);
    const auto voxel = questions.tracer(TracerKind::Voxel, {.resolution = 32});
    EXPECT_STREQ(mixed->name(), "bvh+voxel");
    const auto a = questions.pairs(*exact), b = questions.pairs(*voxel), m = questions.pairs(*mixed);
    uint32_t unlike = 0;
    questions.forPairs([&](uint32_t, uint32_t j, size_t bit) {
        const bool marched = shader::seedKey(questions.patch(j)) % kRatio == 0;
        EXPECT_EQ(bitOf(m, bit), bitOf(marched ? b : a, bit));
        unlike += bitOf(a, bit) != bitOf(b, bit);
    });
    EXPECT_GT(unlike, 1000u);

    const std::vector<glm::vec3> targets = {
        {0.6f, 0, 1.99f}, {0.1f, 0, 1.9f}, {0, 0, 1.5f}, {-0.6f, 0, 1.9f}};
    const auto seenExact = questions.seen(*exact, targets), seenVoxel = questions.seen(*voxel, targets);
    const auto seenMixed = questions.seen(*mixed, targets);
    EXPECT_NE(seenExact, seenVoxel);
    for (size_t i = 0; i < seenMixed.size(); ++i)
        EXPECT_EQ(seenMixed[i], (seenVoxel[i] & 0b1001u) | (seenExact[i] & 0b0110u));
    EXPECT_EQ(questions.links(*mixed), questions.links(*voxel)); // one group of samples, the first
}

struct VoxelMethod {
    Method method;
    bool layers = false;
};

class VoxelMethods : public testing::TestWithParam<VoxelMethod> {};

// A room with a plate is lit alike by rays, by marches and by both, within what voxels can tell. It has a
// mesh light and an analytic one, which CPUs sample by code of their own where they trace all rays.
TEST_P(VoxelMethods, bakeTheSameLightNearly) {
    PlateRoom room;
    Scene scene = room.maker.scene();
    Light bulb;
    bulb.transform[3] = {0.6f, 0.5f, 1.4f, 1.0f};
    scene.lights.push_back(bulb);
    const Method method = GetParam().method;
    const auto mean = [&](const VoxelSettings& voxels) {
        const std::unique_ptr<Baker> baker = makeBaker(scene, {.size = room.maker.size(),
                                                               .passes = GetParam().layers ? 0u : 3u,
                                                               .method = method,
                                                               .samples = isPairMethod(method) ? 0u : 64u,
                                                               .voxels = voxels,
                                                               .layers = GetParam().layers});
        while (!baker->solver().done())
            baker->solver().step();
        double sum = 0;
        for (const glm::vec4& light : baker->solver().light())
            sum += light.r;
        return sum;
    };
    const double exact = mean({}), marched = mean({.resolution = 128, .ratio = 1});
    EXPECT_GT(exact, 0.0);
    EXPECT_NEAR(marched / exact, 1.0, 0.03);
    EXPECT_NE(marched, exact);
    EXPECT_NEAR(mean({.resolution = 128, .ratio = 2}) / exact, 1.0, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Solvers, VoxelMethods,
                         testing::Values(VoxelMethod{Method::Pure}, VoxelMethod{Method::Directional},
                                         VoxelMethod{Method::Hybrid}, VoxelMethod{Method::Hybrid, true}),
                         [](const auto& test) {
                             return test.param.layers ? "layers" : std::string(methodName(test.param.method));
                         });

} // namespace
} // namespace relume
