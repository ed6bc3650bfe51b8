// All tracers must see the same: the bits of every pair of patches, and where directions end.
#include "assets/generate/generate.h"
#include "bake/links/directions.h"
#include "bake/trace/make_tracer.h"
#include "bake/vk/commands.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numeric>
#include <ostream>

namespace relume {
namespace {

using shader::kBlockWords;
using shader::kChunk;
using shader::kSuper;
using shader::kSuperBlocks;

constexpr uint32_t kUnitsPerSubmit = 128; // short submits on a software device too
constexpr uint32_t kChunksPerSubmit = 4;
constexpr uint32_t kLinkSamples = 8;
constexpr uint32_t kDiscPoints = 2; // with four replicates the samples of a disc's set
// So many units of a scene are compared, spread evenly: about two million rays. Neighbouring pairs that graze
// one edge would make a bad sample.
constexpr uint32_t kUnits = 1024;

// One ray in a million may pass a triangle's edge on the other side.
constexpr double kMaxPairShare = 1e-6;
// A direction that meets an edge of two charts may end on either.
constexpr double kMaxLinkShare = 2e-4;

/// Holds the visibility of all pairs and the rays that it took.
struct Visibility {
    std::vector<uint32_t> bits; // unit by unit, as OcclusionWork has them
    uint64_t rays = 0;
};

/// Runs every tracer of the device on one scene.
class Comparison {
public:
    Comparison(const Scene& scene, uint32_t size)
        : baker_(makeBaker(scene, {.size = size})), chunks_(baker_->patches().chunkCount()),
          commands_(testDevice()) {
        const uint32_t rows = (chunks_ + kSuper - 1) / kSuper;
        for (uint32_t row = 0; row < rows; ++row) {
            for (uint32_t column = row; column < rows; ++column)
                supers_.push_back({row, column, 0, {}, {}, 0});
        }
        std::vector<uint32_t> written; // the others are padding or seen from the other end
        for (uint32_t unit = 0; unit < supers_.size() * kSuperBlocks; ++unit) {
            const auto [row, column] = chunksOf(unit);
            if (column < chunks_ && row <= column) written.push_back(unit);
        }
        const size_t kept = std::min<size_t>(kUnits, written.size());
        for (size_t i = 0; i < kept; ++i)
            units_.push_back(written[i * written.size() / kept]);
    }

    const PatchSet& patches() const { return baker_->patches(); }

    std::unique_ptr<Tracer> tracer(TracerKind kind) {
        return makeTracer(kind, testDevice(), patches().scene, baker_->light().patches);
    }

    Visibility pairs(Tracer& tracer) {
        const vk::Buffer sends =
            vk::makeBuffer(testDevice(), std::vector<uint32_t>(chunks_, 1u), "chunk sends");
        const auto slots = static_cast<uint32_t>(supers_.size()) * kSuperBlocks;
        const vk::Buffer bits = vk::makeBuffer(
            testDevice(), std::vector<uint32_t>(size_t{slots} * kBlockWords, 0u), "visibility bits");
        const vk::Buffer rays =
            vk::makeBuffer(testDevice(), std::vector<uint32_t>(2 * shader::kRayCounters, 0u), "ray counters");
        std::vector<uint32_t*> host;
        for (size_t s = 0; s < supers_.size(); ++s) {
            const size_t offset = s * shader::kSuperWords;
            supers_[s].bits = bits.address() + offset * sizeof(uint32_t);
            host.push_back(bits.mapped() ? static_cast<uint32_t*>(bits.mapped()) + offset : nullptr);
        }
        const vk::Buffer supers = vk::makeBuffer(testDevice(), supers_, "super-blocks");
        for (size_t first = 0; first < units_.size(); first += kUnitsPerSubmit) {
            VkCommandBuffer cmd = commands_.begin();
            for (size_t i = first; i < std::min(first + kUnitsPerSubmit, units_.size()); ++i) {
                tracer.occlusion(cmd, {.supers = supers_,
                                       .superBuffer = &supers,
                                       .bits = host,
                                       .firstUnit = units_[i],
                                       .unitCount = 1,
                                       .sends = &sends,
                                       .rays = &rays});
            }
            vk::hostBarrier(cmd);
            commands_.run();
        }
        const auto counters = vk::readBuffer<uint32_t>(testDevice(), rays, shader::kRayCounters);
        return {vk::readBuffer<uint32_t>(testDevice(), bits, size_t{slots} * kBlockWords),
                std::accumulate(counters.begin(), counters.end(), uint64_t{0})};
    }

    /// Returns the links of all patches, as ClosestWork has them. `disc` is vec2[kDiscPoints]; nullptr: Sobol
    /// points.
    std::vector<uint32_t> links(Tracer& tracer, Rotation rotation, const vk::Buffer* disc) {
        std::vector<uint32_t> all;
        const vk::Buffer buffer(
            testDevice(), {.size = VkDeviceSize{kChunksPerSubmit} * kLinkSamples * kChunk * sizeof(uint32_t),
                           .memory = vk::Memory::Host,
                           .name = "links"});
        for (uint32_t first = 0; first < chunks_; first += kChunksPerSubmit) {
            const uint32_t count = std::min(kChunksPerSubmit, chunks_ - first);
            VkCommandBuffer cmd = commands_.begin();
            tracer.closest(cmd, {.firstChunk = first,
                                 .chunkCount = count,
                                 .firstSample = 0,
                                 .sampleCount = kLinkSamples,
                                 .rotation = rotation,
                                 .disc = disc,
                                 .discCount = kDiscPoints,
                                 .links = &buffer});
            vk::hostBarrier(cmd);
            commands_.run();
            const auto* values = static_cast<const uint32_t*>(buffer.mapped());
            all.insert(all.end(), values, values + size_t{count} * kLinkSamples * kChunk);
        }
        return all;
    }

    /// Counts the pairs that only one of both sees.
    uint64_t unlikePairs(const Visibility& a, const Visibility& b, std::string& example) const {
        uint64_t unlike = 0;
        for (uint32_t unit : units_) {
            const auto [row, column] = chunksOf(unit);
            for (uint32_t word = 0; word < kBlockWords; ++word) {
                const size_t at = size_t{unit} * kBlockWords + word;
                const uint32_t difference = a.bits[at] ^ b.bits[at];
                if (difference == 0) continue;
                unlike += static_cast<uint32_t>(std::popcount(difference));
                const uint32_t i = row * kChunk + word / 2;
                const uint32_t j =
                    column * kChunk + word % 2 * 32 + static_cast<uint32_t>(std::countr_zero(difference));
                example += "; patch " + place(i) + " and patch " + place(j);
            }
        }
        return unlike;
    }

private:
    std::pair<uint32_t, uint32_t> chunksOf(uint32_t unit) const {
        const SuperBlock super = supers_[unit / kSuperBlocks];
        return {super.row * kSuper + unit % kSuperBlocks / kSuper, super.column * kSuper + unit % kSuper};
    }

    std::string place(uint32_t index) const {
        const glm::vec3 p = patches().scene.patches[index].position;
        return std::to_string(index) + " at " + std::to_string(p.x) + " " + std::to_string(p.y) + " " +
               std::to_string(p.z);
    }

    std::unique_ptr<Baker> baker_;
    uint32_t chunks_;
    vk::Commands commands_;
    std::vector<SuperBlock> supers_;
    std::vector<uint32_t> units_; // that are compared
};

struct AgreementCase {
    const char* scene;
    float scale;
    uint32_t size; // lightmap edge [texels]
};
void PrintTo(const AgreementCase& c, std::ostream* out) {
    *out << c.scene << " x " << c.scale << " at " << c.size;
}

class Agreement : public testing::TestWithParam<AgreementCase> {};

vk::Buffer testDisc() {
    const std::vector<glm::dvec2> points = evenRings(largestEmptyCircleDisc(kDiscPoints));
    vk::Buffer buffer(testDevice(),
                      {.size = kDiscPoints * sizeof(glm::vec2), .memory = vk::Memory::Host, .name = "disc"});
    for (uint32_t i = 0; i < kDiscPoints; ++i)
        static_cast<glm::vec2*>(buffer.mapped())[i] = glm::vec2(points[i]);
    return buffer;
}

void expectAlike(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b, const std::string& names) {
    uint64_t unlike = 0, unlikeSky = 0;
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        unlike += a[i] != b[i];
        unlikeSky += (a[i] == shader::kLinkSky) != (b[i] == shader::kLinkSky);
    }
    EXPECT_LE(double(unlike), kMaxLinkShare * double(a.size()))
        << names << ": " << unlike << " of " << a.size();
    EXPECT_LE(unlikeSky, 1u) << names;
}

} // namespace

TEST_P(Agreement, OfAllTracers) {
    const AgreementCase& c = GetParam();
    Comparison comparison(scaled(generateScene(c.scene), c.scale), c.size);
    const std::vector<TracerKind> kinds = tracersOfTestDevice();
    std::vector<Visibility> pairs;
    const vk::Buffer disc = testDisc();
    std::vector<std::vector<uint32_t>> links, discLinks;
    uint64_t rays = 0; // a tracer may know some answers without a ray: the one that asks most counts
    for (TracerKind kind : kinds) {
        const std::unique_ptr<Tracer> tracer = comparison.tracer(kind);
        pairs.push_back(comparison.pairs(*tracer));
        links.push_back(comparison.links(*tracer, Rotation::Patch, nullptr));
        discLinks.push_back(comparison.links(*tracer, Rotation::Patch, &disc));
        rays = std::max(rays, pairs.back().rays);
    }
    uint64_t seen = 0;
    for (uint32_t word : pairs[0].bits)
        seen += static_cast<uint32_t>(std::popcount(word));
    EXPECT_GT(seen, rays / 20); // something was compared
    EXPECT_LT(seen, rays);

    for (size_t a = 0; a < kinds.size(); ++a) {
        for (size_t b = a + 1; b < kinds.size(); ++b) {
            const std::string names = std::string(tracerName(kinds[a])) + " and " + tracerName(kinds[b]);
            std::string example;
            const uint64_t unlike = comparison.unlikePairs(pairs[a], pairs[b], example);
            const double expected = kMaxPairShare * double(rays);
            EXPECT_LE(double(unlike), expected + 3 * std::sqrt(expected)) // 3 sigma of so small a sample
                << names << ": " << unlike << " of " << rays << " rays" << example.substr(0, 1000);
            expectAlike(links[a], links[b], names);
            expectAlike(discLinks[a], discLinks[b], names + " by a disc's points");
        }
    }
}

// The scenes' charts lie on multiples of 1/128: at other sizes texel centres lie on edges, where a patch of
// the floor is in the plane of the wall and what it sees is a matter of the last bit.
INSTANTIATE_TEST_SUITE_P(
    Scenes, Agreement,
    testing::Values(AgreementCase{"cornell_geom", 1.0f, 128}, AgreementCase{"cornell_layers", 1.0f, 128},
                    AgreementCase{"cornell_statue", 1.0f, 128}, AgreementCase{"gallery", 1.0f, 128},
                    AgreementCase{"octagon", 1.0f, 128}, AgreementCase{"cornell_geom", 0.01f, 128},
                    AgreementCase{"cornell_geom", 1000.0f, 128}));

} // namespace relume
