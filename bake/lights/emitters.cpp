#include "bake/lights/emitters.h"

#include "assets/base/log.h"
#include "bake/lights/emitter_pieces.h"
#include "bake/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace relume {
namespace {

using shader::EmitterPolygon;

constexpr double kEmitterOffset = 1e-4; // of a texel's size, as patches have it
constexpr double kCornerError = 4.0 * std::numeric_limits<float>::epsilon(); // of a coordinate, likewise
constexpr double kFlat = 1e-5; // of a polygon's size: corners this near to their place count as in it
constexpr double kUvError = 1e-5;

/// Two emitting triangles that may become one: apex0, from, apex1, to is the quadrilateral, from - to the
/// edge that goes.
struct Pair {
    uint32_t triangle0 = 0, triangle1 = 0;
    uint32_t apex0 = 0, from = 0, apex1 = 0, to = 0; // corner indices into the mesh's arrays
    double edge = 0;                                 // [m], length of the edge that goes
    bool isParallelogram = false;
};

class EmitterBuilder {
public:
    EmitterBuilder(const Scene& scene, const WorldMesh& mesh, const EmitterDesc& desc)
        : scene_(scene), mesh_(mesh), desc_(desc) {}
    EmitterSet build();

private:
    bool emits(uint32_t triangle) const;
    const EmitterChoice* choiceOf(uint32_t triangle) const;
    glm::vec3 factorOf(uint32_t triangle) const {
        const EmitterChoice* choice = choiceOf(triangle);
        return choice ? choice->factor : scene_.materials[mesh_.material[triangle]].emission;
    }
    glm::dvec3 at(uint32_t corner) const { return mesh_.positions[corner]; }
    glm::dvec3 front(uint32_t triangle) const; // normal times twice the area
    double texelSize(uint32_t triangle) const;
    float offsetOf(const EmitterPolygon& polygon) const;
    std::vector<Pair> findPairs() const;
    bool makePair(uint32_t t0, uint32_t k0, uint32_t t1, uint32_t k1, Pair& pair) const;
    bool variesLinearly(const Pair& pair) const;
    void addQuad(const Pair& pair);
    void addTriangle(uint32_t triangle);
    void addSurface(const std::array<uint32_t, 3>& corners, uint32_t triangle, bool isTriangle);
    void addPieces();
    void add(EmitterPolygon polygon);

    const Scene& scene_;
    const WorldMesh& mesh_;
    const EmitterDesc& desc_;
    std::vector<uint32_t> emitting_; // triangles
    double meanTexel_ = 0;           // [m], for triangles that have none of their own
    std::vector<EmitterSurface> surfaces_;
    EmitterSet set_;
};

// Returns the choice that the triangle belongs to, or nullptr where there is none.
const EmitterChoice* EmitterBuilder::choiceOf(uint32_t triangle) const {
    const LightKey key{LightKey::Kind::Emitter, mesh_.instance[triangle], mesh_.material[triangle]};
    const auto found = std::lower_bound(
        desc_.only.begin(), desc_.only.end(), key,
        [](const EmitterChoice& choice, const LightKey& wanted) { return choice.key < wanted; });
    return found != desc_.only.end() && found->key == key ? &*found : nullptr;
}

bool EmitterBuilder::emits(uint32_t triangle) const {
    const uint32_t material = mesh_.material[triangle];
    if (material >= scene_.materials.size()) return false; // glTF's default one
    if (!desc_.only.empty()) return choiceOf(triangle) != nullptr;
    const glm::vec3 emission = scene_.materials[material].emission;
    return emission.r > 0 || emission.g > 0 || emission.b > 0;
}

glm::dvec3 EmitterBuilder::front(uint32_t triangle) const {
    const uint32_t i = 3 * triangle;
    return glm::cross(at(i + 1) - at(i), at(i + 2) - at(i));
}

// Returns the size of a triangle's texel [m]; it is never more than the triangle is wide, as for a patch that
// stands for a whole small chart.
double EmitterBuilder::texelSize(uint32_t triangle) const {
    const double area = 0.5 * glm::length(front(triangle));
    double texel = meanTexel_;
    if (mesh_.chart[triangle] != kNoChart) {
        const glm::vec2* uv = &mesh_.lightmapUv[size_t{triangle} * 3];
        const glm::dvec2 e1(uv[1] - uv[0]), e2(uv[2] - uv[0]);
        const double uvArea = 0.5 * std::abs(e1.x * e2.y - e1.y * e2.x);
        if (uvArea > 0) texel = std::sqrt(area / uvArea) / desc_.size;
    }
    return std::min(texel, std::sqrt(area));
}

float EmitterBuilder::offsetOf(const EmitterPolygon& p) const {
    double reach = 0;
    for (const glm::vec3& c : {p.c0, p.c1, p.c2, p.c3})
        reach = std::max({reach, std::abs(double{c.x}), std::abs(double{c.y}), std::abs(double{c.z})});
    return static_cast<float>(kEmitterOffset * texelSize(p.triangle) + kCornerError * reach);
}

// Tells whether what varies over the two triangles does so as over one parallelogram.
bool EmitterBuilder::variesLinearly(const Pair& pair) const {
    // Returns an edge's corner as the other triangle has it.
    const auto twin = [&](uint32_t corner) {
        for (uint32_t k = 0; k < 3; ++k)
            if (mesh_.positions[3 * pair.triangle1 + k] == mesh_.positions[corner])
                return 3 * pair.triangle1 + k;
        return corner;
    };
    const uint32_t from = twin(pair.from), to = twin(pair.to);
    const auto isLinear = [&](const auto& values) {
        const auto isNear = [](const auto& a, const auto& b) {
            const auto d = a - b;
            return std::sqrt(double{glm::dot(d, d)}) <= kUvError * (1 + std::sqrt(double{glm::dot(a, a)}));
        };
        return isNear(values[pair.from], values[from]) && isNear(values[pair.to], values[to]) &&
               isNear(values[pair.apex0] + values[pair.apex1], values[pair.from] + values[pair.to]);
    };
    const Material& material = scene_.materials[mesh_.material[pair.triangle0]];
    if (material.emissionTexture.texture >= 0 && !isLinear(mesh_.emissionUv)) return false;
    return material.alphaMode != AlphaMode::Mask || (isLinear(mesh_.baseUv) && isLinear(mesh_.colors));
}

// Makes the pair of two triangles whose edges k0 and k1 (corner k to the next) are the same in opposite
// directions; returns false where they cannot become one.
bool EmitterBuilder::makePair(uint32_t t0, uint32_t k0, uint32_t t1, uint32_t k1, Pair& pair) const {
    if (mesh_.material[t0] != mesh_.material[t1]) return false;
    pair = {t0, t1, 3 * t0 + (k0 + 2) % 3, 3 * t0 + k0, 3 * t1 + (k1 + 2) % 3, 3 * t0 + (k0 + 1) % 3};
    const glm::dvec3 a = at(pair.apex0), b = at(pair.from), c = at(pair.apex1), d = at(pair.to);
    pair.edge = glm::length(d - b);
    const glm::dvec3 n0 = glm::normalize(front(t0)), n1 = glm::normalize(front(t1));
    const double size =
        std::max({glm::length(b - a), glm::length(c - b), glm::length(d - c), glm::length(a - d)});
    const double reach = std::max({glm::length(a), glm::length(b), glm::length(c), glm::length(d)});
    const double error = kFlat * size + kCornerError * reach;
    if (glm::dot(n0, n1) < 0.999 || std::abs(glm::dot(n0, c - b)) > error) return false;
    // The quadrilateral is convex where the two meet, by enough that rounding does not matter.
    const double least = kFlat * size * size;
    if (glm::dot(n0, glm::cross(b - a, c - b)) < least || glm::dot(n0, glm::cross(d - c, a - d)) < least)
        return false;
    pair.isParallelogram = glm::length(a + c - b - d) <= error;
    const Material& material = scene_.materials[mesh_.material[t0]];
    return !variesOverSurface(material) || (pair.isParallelogram && variesLinearly(pair));
}

// Returns the pairs: parallelograms first, then those that lose the longer edge. A grid's triangles become
// its squares.
std::vector<Pair> EmitterBuilder::findPairs() const {
    using Coordinates = std::array<float, 3>;
    std::map<std::pair<Coordinates, Coordinates>, std::pair<uint32_t, uint32_t>>
        edges; // to triangle and corner
    const auto point = [&](uint32_t corner) {
        const glm::vec3 p = mesh_.positions[corner] + 0.0f; // -0 becomes 0
        return Coordinates{p.x, p.y, p.z};
    };
    std::vector<Pair> pairs;
    for (uint32_t t : emitting_) {
        for (uint32_t k = 0; k < 3; ++k) {
            const Coordinates from = point(3 * t + k), to = point(3 * t + (k + 1) % 3);
            const auto other = edges.find({to, from});
            Pair pair;
            if (other != edges.end() && makePair(other->second.first, other->second.second, t, k, pair))
                pairs.push_back(pair);
            edges.try_emplace({from, to}, t, k);
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        if (a.isParallelogram != b.isParallelogram) return a.isParallelogram;
        return a.edge > b.edge;
    });
    return pairs;
}

void EmitterBuilder::add(EmitterPolygon polygon) {
    polygon.offset = offsetOf(polygon);
    set_.polygons.push_back(polygon);
    set_.power += emitterPower(polygon);
    if (!scene_.materials[mesh_.material[polygon.triangle]].doubleSided) return;
    if (polygon.shape == shader::kEmitterTriangle) {
        std::swap(polygon.c1, polygon.c2);
        polygon.c3 = polygon.c2;
    } else {
        std::swap(polygon.c1, polygon.c3);
        polygon.split = 1.0f - polygon.split;
    }
    set_.polygons.push_back(polygon);
    set_.power += emitterPower(polygon);
}

// Adds a surface with these corners at (0, 0), (1, 0) and (0, 1).
void EmitterBuilder::addSurface(const std::array<uint32_t, 3>& corners, uint32_t triangle, bool isTriangle) {
    EmitterSurface s;
    const auto fill = [&](auto* out, const auto& values) {
        using Value = std::remove_pointer_t<decltype(out)>;
        const Value base(values[corners[0]]);
        out[0] = base, out[1] = Value(values[corners[1]]) - base, out[2] = Value(values[corners[2]]) - base;
    };
    fill(s.position, mesh_.positions);
    fill(s.emissionUv, mesh_.emissionUv);
    fill(s.baseUv, mesh_.baseUv);
    const auto alpha = [&](size_t k) { return double{mesh_.colors[corners[k]].a}; };
    s.alpha[0] = alpha(0), s.alpha[1] = alpha(1) - alpha(0), s.alpha[2] = alpha(2) - alpha(0);
    s.area = glm::length(glm::cross(s.position[1], s.position[2])) * (isTriangle ? 0.5 : 1.0);
    s.isTriangle = isTriangle;
    s.triangle = triangle, s.material = mesh_.material[triangle];
    surfaces_.push_back(s);
}

void EmitterBuilder::addTriangle(uint32_t t) {
    const Material& material = scene_.materials[mesh_.material[t]];
    if (variesOverSurface(material)) return addSurface({3 * t, 3 * t + 1, 3 * t + 2}, t, true);
    EmitterPolygon p{};
    p.c0 = mesh_.positions[3 * t], p.c1 = mesh_.positions[3 * t + 1],
    p.c2 = p.c3 = mesh_.positions[3 * t + 2];
    p.area = static_cast<float>(0.5 * glm::length(front(t)));
    p.split = 1, p.shape = shader::kEmitterTriangle;
    p.radiance = factorOf(t), p.triangle = t;
    add(p);
}

void EmitterBuilder::addQuad(const Pair& pair) {
    const uint32_t t = std::min(pair.triangle0, pair.triangle1);
    const Material& material = scene_.materials[mesh_.material[t]];
    if (variesOverSurface(material)) return addSurface({pair.apex0, pair.from, pair.to}, t, false);
    EmitterPolygon p{};
    p.c0 = mesh_.positions[pair.apex0], p.c1 = mesh_.positions[pair.from];
    p.c2 = mesh_.positions[pair.apex1], p.c3 = mesh_.positions[pair.to];
    p.area =
        static_cast<float>(0.5 * (glm::length(front(pair.triangle0)) + glm::length(front(pair.triangle1))));
    const glm::dvec3 diagonal = at(pair.apex1) - at(pair.apex0);
    const double first = glm::length(glm::cross(at(pair.from) - at(pair.apex0), diagonal));
    const double second = glm::length(glm::cross(diagonal, at(pair.to) - at(pair.apex0)));
    p.split = static_cast<float>(first / (first + second));
    p.shape = pair.isParallelogram ? shader::kEmitterParallelogram : shader::kEmitterQuad;
    p.radiance = factorOf(t), p.triangle = t;
    add(p);
}

void EmitterBuilder::addPieces() {
    const PieceList list = splitEmission(scene_, surfaces_, desc_.maxPieces, !desc_.only.empty());
    for (const EmitterPiece& piece : list.pieces) {
        const EmitterSurface& s = surfaces_[piece.surface];
        const auto corner = [&](double a, double b) {
            const glm::dvec2 st = piece.origin + a * piece.along0 + b * piece.along1;
            return glm::vec3(s.position[0] + st.x * s.position[1] + st.y * s.position[2]);
        };
        EmitterPolygon p{};
        p.c0 = corner(0, 0), p.c1 = corner(1, 0);
        p.c2 = s.isTriangle ? corner(0, 1) : corner(1, 1), p.c3 = corner(0, 1);
        p.area = static_cast<float>(piece.area);
        p.split = s.isTriangle ? 1.0f : 0.5f;
        p.shape = s.isTriangle ? shader::kEmitterTriangle : shader::kEmitterParallelogram;
        p.radiance = glm::vec3(piece.radiance), p.triangle = s.triangle;
        if (!desc_.only.empty()) p.radiance *= factorOf(s.triangle);
        add(p);
    }
    if (list.capped)
        spdlog::warn("{}: emission textures are split into {} pieces only: fine detail of their light is "
                     "averaged; simpler emission textures mend it",
                     scene_.path, list.pieces.size());
}

EmitterSet EmitterBuilder::build() {
    double area = 0, uvArea = 0;
    for (uint32_t t = 0; t < mesh_.triangleCount(); ++t) {
        if (emits(t)) emitting_.push_back(t);
        if (mesh_.chart[t] == kNoChart) continue;
        const glm::vec2* uv = &mesh_.lightmapUv[size_t{t} * 3];
        const glm::dvec2 e1(uv[1] - uv[0]), e2(uv[2] - uv[0]);
        area += 0.5 * glm::length(front(t)), uvArea += 0.5 * std::abs(e1.x * e2.y - e1.y * e2.x);
    }
    meanTexel_ = uvArea > 0 ? std::sqrt(area / uvArea) / desc_.size : std::numeric_limits<double>::max();
    const std::vector<Pair> pairs = findPairs();
    constexpr size_t kAlone = std::numeric_limits<size_t>::max();
    std::vector<size_t> pairOf(mesh_.triangleCount(), kAlone);
    for (size_t i = 0; i < pairs.size(); ++i)
        if (pairOf[pairs[i].triangle0] == kAlone && pairOf[pairs[i].triangle1] == kAlone)
            pairOf[pairs[i].triangle0] = pairOf[pairs[i].triangle1] = i;
    for (uint32_t t : emitting_) { // in the mesh's order, whatever order the pairs were found in
        if (pairOf[t] == kAlone)
            addTriangle(t);
        else if (t == std::min(pairs[pairOf[t]].triangle0, pairs[pairOf[t]].triangle1))
            addQuad(pairs[pairOf[t]]);
    }
    addPieces();
    set_.nodes = buildLightTree(set_.polygons);
    if (!set_.polygons.empty() && desc_.only.empty())
        spdlog::info("emitters: {} polygons of {} triangles", set_.polygons.size(), emitting_.size());
    return std::move(set_);
}

} // namespace

EmitterSet buildEmitters(const Scene& scene, const WorldMesh& mesh, const EmitterDesc& desc) {
    return EmitterBuilder(scene, mesh, desc).build();
}

} // namespace relume
