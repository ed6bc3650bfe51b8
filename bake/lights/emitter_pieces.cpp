#include "bake/lights/emitter_pieces.h"

#include "assets/images/float_image.h"
#include "bake/base/shader_types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

namespace relume {
namespace shader {
namespace {

// Applies the tracers' alpha test to one image.
struct MaskTexels {
    const Image* image;
    float alphaTexel(uint texel) { return float(image->rgba[size_t{texel} * 4 + 3]) / 255.0f; }
#include "shaders/lib/rays/alpha.glsl"
};

} // namespace
} // namespace shader

namespace {

constexpr double kSpread = 0.03;     // of the brightest radiance: what differs less counts as one
constexpr double kLeastTexels = 2.0; // along an edge: below, interpolated texels hardly differ
constexpr double kMostStretch = 8.0; // [1] of a piece, in texels
constexpr int kLeastGrid = 8;        // samples along an edge of a piece, at least
constexpr int kMostGrid = 1024;      // and at most; else one per texel
constexpr uint32_t kOpaque = 0xffffffffu;

/// The emission of one material, per texture coordinates.
class EmissionTexture {
public:
    EmissionTexture(const Scene& scene, const Material& material, bool unit)
        : factor_(unit ? glm::vec3(1.0f) : material.emission) {
        for (uint32_t i = 0; i < 256; ++i)
            linear_[i] = static_cast<float>(linearFromSrgb(i / 255.0));
        if (material.emissionTexture.texture >= 0) {
            texture_ = &scene.textures[static_cast<size_t>(material.emissionTexture.texture)];
            image_ = &scene.images[static_cast<size_t>(texture_->image)];
        }
        if (material.alphaMode != AlphaMode::Mask) return;
        isMasked_ = true;
        mask_ = {material.baseColor.a, material.alphaCutoff, kOpaque, 0, 0, 0, 0};
        if (material.baseColorTexture.texture < 0) return;
        const Texture& base = scene.textures[static_cast<size_t>(material.baseColorTexture.texture)];
        maskTexels_.image = &scene.images[static_cast<size_t>(base.image)];
        mask_ = {material.baseColor.a,
                 material.alphaCutoff,
                 0,
                 maskTexels_.image->width,
                 maskTexels_.image->height,
                 static_cast<uint32_t>(base.wrapS),
                 static_cast<uint32_t>(base.wrapT)};
    }

    /// Returns the emission at (s, t) [cd/m^2]; black in a hole.
    glm::dvec3 at(const EmitterSurface& surface, glm::dvec2 st) {
        const auto on = [&](const auto* value) { return value[0] + st.x * value[1] + st.y * value[2]; };
        if (isMasked_) {
            const glm::vec2 uv(on(surface.baseUv));
            const auto alpha = static_cast<float>(on(surface.alpha));
            if (!maskTexels_.alphaSolid({uv, uv, uv, alpha, alpha, alpha, 0}, mask_, 0.0f, 0.0f)) return {};
        }
        return image_ ? factor_ * sample(on(surface.emissionUv)) : factor_;
    }
    /// Returns how many texels an edge in the surface's (s, t) spans, of the finer texture.
    double texels(const EmitterSurface& surface, glm::dvec2 edge) const {
        const auto span = [&](const glm::dvec2* uv, double width, double height) {
            return glm::length((edge.x * uv[1] + edge.y * uv[2]) * glm::dvec2(width, height));
        };
        double most = 0;
        if (image_) most = span(surface.emissionUv, image_->width, image_->height);
        if (maskTexels_.image) most = std::max(most, span(surface.baseUv, mask_.width, mask_.height));
        // The alpha of the corners alone has no texels: it counts as if it had some.
        constexpr double kAlphaTexels = 64;
        if (isMasked_) most = std::max(most, kAlphaTexels * glm::length(edge));
        return most;
    }

private:
    glm::dvec3 texel(int64_t x, int64_t y) const {
        const size_t at = (wrapped(y, image_->height, texture_->wrapT) * image_->width +
                           wrapped(x, image_->width, texture_->wrapS)) *
                          4;
        const uint8_t* p = &image_->rgba[at];
        return {linear_[p[0]], linear_[p[1]], linear_[p[2]]};
    }
    static size_t wrapped(int64_t i, int64_t n, Wrap mode) {
        if (mode == Wrap::ClampToEdge) return static_cast<size_t>(std::clamp<int64_t>(i, 0, n - 1));
        const int64_t period = mode == Wrap::MirroredRepeat ? 2 * n : n;
        const int64_t k = (i % period + period) % period;
        return static_cast<size_t>(k < n ? k : period - 1 - k);
    }
    glm::dvec3 sample(glm::dvec2 uv) const {
        const glm::dvec2 p = uv * glm::dvec2(image_->width, image_->height) - (texture_->nearest ? 0.0 : 0.5);
        const glm::dvec2 corner = glm::floor(p);
        const auto x = static_cast<int64_t>(corner.x), y = static_cast<int64_t>(corner.y);
        if (texture_->nearest) return texel(x, y);
        const glm::dvec2 f = p - corner;
        return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), f.x),
                        glm::mix(texel(x, y + 1), texel(x + 1, y + 1), f.x), f.y);
    }

    glm::dvec3 factor_; // [cd/m^2]
    const Texture* texture_ = nullptr;
    const Image* image_ = nullptr;
    bool isMasked_ = false;
    shader::AlphaMaterial mask_{};
    shader::MaskTexels maskTexels_{nullptr};
    std::array<float, 256> linear_{};
};

/// A piece with what its samples say.
struct Sampled {
    EmitterPiece piece;
    double brightest = 0;                  // of all samples and components
    double spread = 0;                     // largest difference of two samples in one component
    double texels0 = 0, texels1 = 0;       // along its edges
    std::array<double, 4> sum{}, square{}; // by quarter, (t > 1/2) * 2 + (s > 1/2), of the components' sum
    double quarter = 0;                    // samples in each
    double priority() const { return spread * piece.area; }
};

class Splitter {
public:
    Splitter(const Scene& scene, const std::vector<EmitterSurface>& surfaces, bool unit)
        : surfaces_(surfaces) {
        std::vector<int> textureOf(scene.materials.size(), -1);
        for (const EmitterSurface& s : surfaces) {
            int& index = textureOf[s.material];
            if (index < 0) {
                index = static_cast<int>(textures_.size());
                textures_.emplace_back(scene, scene.materials[s.material], unit);
            }
            texture_.push_back(static_cast<size_t>(index));
        }
    }
    PieceList split(uint32_t maxPieces);

private:
    Sampled sampled(const EmitterPiece& piece);
    bool isWhole(const Sampled& s) const;
    bool cutsFirstEdge(const Sampled& s) const;
    std::array<EmitterPiece, 2> halves(const Sampled& s) const;
    std::array<EmitterPiece, 2> triangleHalves(const EmitterPiece& p) const;

    const std::vector<EmitterSurface>& surfaces_;
    std::vector<EmissionTexture> textures_;
    std::vector<size_t> texture_; // of each surface
    double brightest_ = 0;        // [cd/m^2], of all surfaces
};

Sampled Splitter::sampled(const EmitterPiece& piece) {
    const EmitterSurface& surface = surfaces_[piece.surface];
    EmissionTexture& texture = textures_[texture_[piece.surface]];
    Sampled result;
    result.piece = piece;
    result.texels0 = texture.texels(surface, piece.along0),
    result.texels1 = texture.texels(surface, piece.along1);
    const auto grid = [](double texels) { // even, for the quarters
        return 2 *
               static_cast<int>(std::ceil(0.5 * std::clamp(texels, double{kLeastGrid}, double{kMostGrid})));
    };
    int columns = grid(result.texels0), rows = grid(result.texels1);
    if (surface.isTriangle) columns = rows = std::max(columns, rows);
    glm::dvec3 sum(0), lo(std::numeric_limits<double>::max()), hi(0);
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            glm::dvec2 st((column + 0.5) / columns, (row + 0.5) / rows);
            const size_t quarter = (st.y > 0.5 ? 2u : 0u) + (st.x > 0.5 ? 1u : 0u);
            // A triangle is half the parallelogram; the other half is folded onto it.
            if (surface.isTriangle && st.x + st.y > 1) st = 1.0 - st;
            const glm::dvec3 value =
                texture.at(surface, piece.origin + st.x * piece.along0 + st.y * piece.along1);
            sum += value, lo = glm::min(lo, value), hi = glm::max(hi, value);
            const double total = value.r + value.g + value.b;
            result.sum[quarter] += total, result.square[quarter] += total * total;
        }
    }
    result.quarter = 0.25 * rows * columns;
    result.piece.radiance = sum / (4 * result.quarter);
    result.brightest = std::max({hi.r, hi.g, hi.b});
    result.spread = std::max({hi.r - lo.r, hi.g - lo.g, hi.b - lo.b});
    return result;
}

bool Splitter::isWhole(const Sampled& s) const {
    return s.spread <= kSpread * brightest_ || std::max(s.texels0, s.texels1) < kLeastTexels;
}

// Cuts a triangle across its longest edge, in texels.
std::array<EmitterPiece, 2> Splitter::triangleHalves(const EmitterPiece& p) const {
    const EmissionTexture& texture = textures_[texture_[p.surface]];
    std::array<glm::dvec2, 3> corner = {p.origin, p.origin + p.along0, p.origin + p.along1};
    size_t longest = 0;
    double most = -1;
    for (size_t k = 0; k < 3; ++k) {
        const double texels = texture.texels(surfaces_[p.surface], corner[(k + 1) % 3] - corner[k]);
        if (texels > most * (1 + 1e-9)) most = texels, longest = k;
    }
    const glm::dvec2 a = corner[(longest + 2) % 3], b = corner[longest], c = corner[(longest + 1) % 3];
    const glm::dvec2 middle = 0.5 * (b + c);
    std::array<EmitterPiece, 2> parts = {p, p};
    parts[0].origin = parts[1].origin = a;
    parts[0].along0 = b - a, parts[0].along1 = middle - a;
    parts[1].along0 = middle - a, parts[1].along1 = c - a;
    return parts;
}

// Tells whether to cut across the first edge: the one that leaves less variance in the halves, as long as
// pieces keep a decent shape.
bool Splitter::cutsFirstEdge(const Sampled& s) const {
    const double stretch = s.texels0 / std::max(s.texels1, 1e-9);
    if (s.texels1 < kLeastTexels || stretch > kMostStretch) return true;
    if (s.texels0 < kLeastTexels || stretch < 1 / kMostStretch) return false;
    const auto variance = [&](size_t q, size_t r) { // of the half made of these quarters, times its samples
        const double sum = s.sum[q] + s.sum[r];
        return s.square[q] + s.square[r] - sum * sum / (2 * s.quarter);
    };
    const double first = variance(0, 2) + variance(1, 3), second = variance(0, 1) + variance(2, 3);
    // Where both are nearly equal, the pattern is finer than the cut: then the longer edge is cut.
    if (std::abs(first - second) <= 0.01 * std::max(first, second)) return stretch >= 1;
    return first < second;
}

std::array<EmitterPiece, 2> Splitter::halves(const Sampled& s) const {
    std::array<EmitterPiece, 2> parts = {s.piece, s.piece};
    if (surfaces_[s.piece.surface].isTriangle) {
        parts = triangleHalves(s.piece);
    } else if (cutsFirstEdge(s)) {
        parts[0].along0 *= 0.5, parts[1].along0 *= 0.5;
        parts[1].origin += parts[1].along0;
    } else {
        parts[0].along1 *= 0.5, parts[1].along1 *= 0.5;
        parts[1].origin += parts[1].along1;
    }
    for (EmitterPiece& part : parts)
        part.area = 0.5 * s.piece.area;
    return parts;
}

PieceList Splitter::split(uint32_t maxPieces) {
    std::vector<Sampled> items;
    for (uint32_t i = 0; i < surfaces_.size(); ++i) {
        EmitterPiece piece;
        piece.surface = i, piece.area = surfaces_[i].area;
        items.push_back(sampled(piece));
        brightest_ = std::max(brightest_, items.back().brightest);
    }
    // The largest comes first; among equals the one made first.
    const auto isBehind = [&](uint32_t a, uint32_t b) {
        const double pa = items[a].priority(), pb = items[b].priority();
        return pa != pb ? pa < pb : a > b;
    };
    std::priority_queue<uint32_t, std::vector<uint32_t>, decltype(isBehind)> open(isBehind);
    uint32_t pieces = 0; // that are not black
    const auto enter = [&](uint32_t i) {
        if (items[i].brightest <= 0) return;
        ++pieces;
        if (!isWhole(items[i])) open.push(i);
    };
    for (uint32_t i = 0; i < items.size(); ++i)
        enter(i);
    PieceList list;
    while (!open.empty()) {
        list.capped = pieces >= maxPieces;
        if (list.capped) break;
        const uint32_t top = open.top();
        open.pop();
        --pieces;
        const std::array<EmitterPiece, 2> parts = halves(items[top]);
        items[top] = sampled(parts[0]);
        items.push_back(sampled(parts[1]));
        enter(top);
        enter(static_cast<uint32_t>(items.size() - 1));
    }
    for (const Sampled& s : items)
        if (s.brightest > 0) list.pieces.push_back(s.piece);
    std::stable_sort(list.pieces.begin(), list.pieces.end(),
                     [](const EmitterPiece& a, const EmitterPiece& b) { return a.surface < b.surface; });
    return list;
}

} // namespace

bool variesOverSurface(const Material& material) {
    return material.emissionTexture.texture >= 0 || material.alphaMode == AlphaMode::Mask;
}

PieceList splitEmission(const Scene& scene, const std::vector<EmitterSurface>& surfaces, uint32_t maxPieces,
                        bool unit) {
    return Splitter(scene, surfaces, unit).split(maxPieces);
}

} // namespace relume
