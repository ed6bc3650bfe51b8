// The RTRad preset's methods are held against its formulas written down once more, plainly: every receiver,
// every sample, every triangle.
#include "assets/generate/generate.h"
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kRtradSize = 32;
constexpr uint32_t kPasses = 2;
constexpr double kReflectivity = 0.9, kClamp = 0.05, kLight = 0.1;

using Texture = std::vector<glm::dvec4>;

/// Holds RTRad's textures and does its passes over them.
class Rtrad {
public:
    /// `seen` has what was found out about pairs of texels of these patches so far: -1 for nothing.
    Rtrad(const PatchSet& set, std::vector<int>& seen)
        : set_(set), seen_(seen), map_(set.scene.texelToPatch),
          ligIn_(size_t{kRtradSize} * kRtradSize, glm::dvec4(0)) {
        for (size_t t = 0; t < map_.size(); ++t)
            if (isPatch(t)) ligIn_[t] = glm::dvec4(glm::dvec3(set.emission[map_[t]]), 1.0);
        ligOut_ = ligIn_;
        seen_.resize(map_.size() * map_.size(), -1);
    }

    void pass(Method method, const PairSettings& pairs, bool first) {
        if (!first) std::swap(ligIn_, ligOut_);
        if (method == Method::Adaptive) subdivide(pairs.node, pairs.threshold);
        if (method == Method::Mipmapped) makeMips();
        for (uint32_t t = 0; t < map_.size(); ++t) {
            if (!isPatch(t)) continue;
            const glm::dvec3 emission(set_.emission[map_[t]]);
            if (glm::length(emission) > kLight) continue;
            receiver_ = t;
            sum_ = glm::dvec4(emission, 0);
            gather(method, method == Method::Adaptive ? 1 : pairs.window);
            ligOut_[t] = glm::dvec4(glm::dvec3(sum_), 1.0);
        }
    }
    const Texture& ligOut() const { return ligOut_; }
    bool isPatch(size_t texel) const { return map_[texel] != shader::kNoPatch; }

private:
    static uint32_t hash(uint32_t x) {
        x = (x ^ 61) ^ (x >> 16);
        x *= 9;
        x ^= x >> 4;
        x *= 0x27d4eb2d;
        return x ^ (x >> 15);
    }

    void gather(Method method, uint32_t s) {
        for (uint32_t y = 0; y < kRtradSize; y += s) {
            for (uint32_t x = 0; x < kRtradSize; x += s) {
                if (!isPatch(y * kRtradSize + x)) continue;
                uint32_t jx = x, jy = y;
                if (method == Method::MonteCarlo) {
                    const uint32_t k = (x + 1) * (y + 1);
                    jx += hash(hash(k) % 7864128) % s;
                    jy += hash(hash(k) % 5490141) % s;
                }
                if (jx >= kRtradSize || jy >= kRtradSize || !isPatch(jy * kRtradSize + jx)) continue;
                const int dx = int(jx) - int(receiver_ % kRtradSize),
                          dy = int(jy) - int(receiver_ / kRtradSize);
                if (dx >= 0 && dy >= 0 && dx < int(s) && dy < int(s)) continue;
                const uint32_t j = jy * kRtradSize + jx;
                const glm::dvec4 light = method == Method::Mipmapped ? mip(x, y, s) : ligIn_[j];
                addSample(j, s * s * ligIn_[j].a, light);
            }
        }
    }

    void addSample(uint32_t j, double weight, const glm::dvec4& light) {
        const shader::Patch &a = set_.scene.patches[map_[receiver_]], &b = set_.scene.patches[map_[j]];
        const glm::dvec3 d = glm::dvec3(b.position) - glm::dvec3(a.position);
        const double r2 = glm::dot(d, d);
        const double ca = glm::dot(d, glm::dvec3(a.shading)), cb = -glm::dot(d, glm::dvec3(b.shading));
        if (weight == 0 || r2 == 0 || ca <= 0 || cb <= 0 || !sees(j)) return;
        const double f = std::min(1.0, b.area * ca * cb / (r2 * 3.14159265358979 * r2));
        const glm::dvec4 mat(glm::dvec3(set_.albedo[map_[receiver_]]), 1.0);
        glm::dvec4 addend = weight * light * mat * (kReflectivity * f);
        if (glm::length(addend) > kClamp) addend *= kClamp / glm::length(addend);
        sum_ += addend;
    }

    bool sees(uint32_t j) {
        int& known = seen_[size_t{receiver_} * map_.size() + j];
        if (known < 0) known = blocked(j) ? 0 : 1;
        return known == 1;
    }
    // Does Moeller and Trumbore's test against every triangle.
    bool blocked(uint32_t j) const {
        const glm::dvec3 from(set_.scene.patches[map_[receiver_]].position);
        const glm::dvec3 to(set_.scene.patches[map_[j]].position);
        const double distance = glm::distance(from, to), tMin = 0.001, tMax = distance - 0.002;
        if (tMax <= tMin) return false;
        const glm::dvec3 direction = (to - from) / distance;
        const std::vector<glm::vec3>& p = set_.scene.mesh.positions;
        for (size_t t = 0; t < p.size(); t += 3) {
            const glm::dvec3 p0(p[t]), e1 = glm::dvec3(p[t + 1]) - p0, e2 = glm::dvec3(p[t + 2]) - p0;
            const glm::dvec3 n = glm::cross(direction, e2), o = from - p0, q = glm::cross(o, e1);
            const double det = glm::dot(e1, n);
            if (det == 0) continue;
            const double u = glm::dot(o, n) / det, v = glm::dot(direction, q) / det,
                         s = glm::dot(e2, q) / det;
            if (u >= 0 && v >= 0 && u + v <= 1 && s >= tMin && s <= tMax) return true;
        }
        return false;
    }

    void subdivide(uint32_t node, double threshold) {
        for (size_t t = 0; t < map_.size(); ++t)
            ligIn_[t].a = isPatch(t) ? 1 : 0;
        for (uint32_t step = 2; step < node; step *= 2) {
            const uint32_t half = step / 2;
            for (uint32_t y = 0; y < kRtradSize; y += step) {
                for (uint32_t x = 0; x < kRtradSize; x += step) {
                    const std::array<uint32_t, 4> c = {y * kRtradSize + x, y * kRtradSize + x + half,
                                                       (y + half) * kRtradSize + x,
                                                       (y + half) * kRtradSize + x + half};
                    glm::dvec3 light(0), normal(0);
                    double weight = 0;
                    bool whole = true;
                    for (uint32_t t : c) {
                        whole = whole && ligIn_[t].a >= half * half;
                        if (!isPatch(t)) continue;
                        light += glm::dvec3(ligIn_[t]) / 4.0;
                        normal += glm::dvec3(set_.scene.patches[map_[t]].shading) / 4.0;
                        weight += ligIn_[t].a;
                    }
                    if (!whole) continue;
                    const double difference =
                        0.5 * glm::distance(light, glm::dvec3(ligIn_[c[0]])) +
                        0.5 * glm::distance(normal, glm::dvec3(set_.scene.patches[map_[c[0]]].shading));
                    if (difference >= threshold) continue;
                    for (uint32_t t : c)
                        ligIn_[t].a = 0;
                    ligIn_[c[0]].a = weight;
                }
            }
        }
    }

    // Makes the mips. kRtradSize is a power of two: a level is the mean of four texels of the one before.
    void makeMips() {
        mips_.assign(1, ligIn_);
        for (uint32_t level = 1, n = kRtradSize / 2; level < 4; ++level, n /= 2) {
            Texture next;
            for (uint32_t y = 0; y < n; ++y)
                for (uint32_t x = 0; x < n; ++x) {
                    const auto at = [&](uint32_t i, uint32_t k) {
                        return mips_.back()[(2 * y + k) * 2 * n + 2 * x + i];
                    };
                    next.push_back((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4.0);
                }
            mips_.push_back(next);
        }
    }
    glm::dvec4 mip(uint32_t x, uint32_t y, uint32_t s) const {
        const uint32_t level = std::min(3u, static_cast<uint32_t>(std::log2(s))), n = kRtradSize >> level;
        const double u = double(x + s / 2.0) / kRtradSize * n - 0.5,
                     v = double(y + s / 2.0) / kRtradSize * n - 0.5;
        const auto at = [&](double i, double k) {
            const auto wrap = [&](double w) { return static_cast<uint32_t>(int(w) + int(n)) % n; };
            return mips_[level][wrap(k) * n + wrap(i)];
        };
        const double i = std::floor(u), k = std::floor(v);
        return glm::mix(glm::mix(at(i, k), at(i + 1, k), u - i),
                        glm::mix(at(i, k + 1), at(i + 1, k + 1), u - i), v - k);
    }

    const PatchSet& set_;
    std::vector<int>& seen_;
    const std::vector<uint32_t>& map_;
    Texture ligIn_, ligOut_;
    std::vector<Texture> mips_;
    uint32_t receiver_ = 0;
    glm::dvec4 sum_{0};
};

struct RtradCase {
    const char* name;
    Method method;
    PairSettings pairs;
};
void PrintTo(const RtradCase& c, std::ostream* out) {
    *out << c.name;
}

class RtradMethods : public testing::TestWithParam<RtradCase> {};
INSTANTIATE_TEST_SUITE_P(
    All, RtradMethods,
    testing::Values(RtradCase{"pure", Method::Pure, {}}, RtradCase{"static2", Method::Static, {.window = 2}},
                    RtradCase{"static8", Method::Static, {.window = 8}},
                    RtradCase{"montecarlo2", Method::MonteCarlo, {.window = 2}},
                    RtradCase{"montecarlo4", Method::MonteCarlo, {.window = 4}},
                    RtradCase{"mipmapped1", Method::Mipmapped, {.window = 1}},
                    RtradCase{"mipmapped4", Method::Mipmapped, {.window = 4}},
                    RtradCase{"mipmapped16", Method::Mipmapped, {.window = 16}},
                    RtradCase{"adaptive2", Method::Adaptive, {.node = 2}},
                    RtradCase{"adaptive8", Method::Adaptive, {.threshold = 0.05, .node = 8}},
                    RtradCase{"adaptive16", Method::Adaptive, {.threshold = 0.5, .node = 16}}),
    [](const auto& test) { return std::string(test.param.name); });

} // namespace

TEST_P(RtradMethods, FollowRtradsFormulas) {
    const RtradCase& c = GetParam();
    // The stride misses the small mesh light of the one, as RTRad's does, and finds the long ones of the
    // other.
    const std::string name = c.method == Method::Static ? "cornell_layers" : "cornell_geom";
    const Scene scene = generateScene(name);
    const auto baker = makeBaker(
        scene, {.size = kRtradSize, .passes = kPasses, .method = c.method, .pairs = c.pairs, .rtrad = true});
    while (!baker->solver().done())
        baker->solver().step();
    const FloatImage image = baker->lightmap({.quantity = Quantity::Radiance, .sew = false});
    static std::map<std::string, std::vector<int>> seen; // cases of one scene ask for the same pairs
    Rtrad rtrad(baker->patches(), seen[name]);
    for (uint32_t p = 0; p < kPasses; ++p)
        rtrad.pass(c.method, c.pairs, p == 0);
    double squares = 0, sum = 0, bounced = 0;
    for (size_t t = 0; t < rtrad.ligOut().size(); ++t) {
        if (!rtrad.isPatch(t)) continue;
        for (size_t k = 0; k < 3; ++k) {
            const double exact = rtrad.ligOut()[t][static_cast<int>(k)];
            squares += (image.planes[k][t] - exact) * (image.planes[k][t] - exact);
            sum += exact;
            bounced += exact < 0.9 ? exact : 0.0;
        }
    }
    // Something arrived; a stride of 8 meets no mesh light at all at this size, and all must then stay dark.
    const bool meetsNoLamp = c.method == Method::Static && c.pairs.window == 8;
    EXPECT_EQ(bounced > 1.0, !meetsNoLamp) << bounced;
    // Texel centres lie on edges at this size, so the last bit decides a few rays.
    const double count = 3.0 * baker->patches().count;
    EXPECT_LT(std::sqrt(squares / count) / (sum / count), 2e-3);
}

} // namespace relume
