#include "assets/generate/town/town_pixels.h"

#include "assets/generate/shapes/paint_image.h"

#include <algorithm>
#include <cmath>

namespace relume::generate {
namespace {

constexpr uint32_t kSide = 256; // [pixels]

// Returns noise in octaves, [0,1]; the coarsest has `cells` cells along a side.
double cloud(const glm::dvec2& p, uint32_t cells, uint32_t seed) {
    double sum = 0.0, weight = 0.5;
    for (uint32_t octave = 0; octave < 4; ++octave, cells *= 2, weight *= 0.5)
        sum += weight * noise(p * double(cells), cells, cells, seed + octave);
    return sum / 0.9375;
}

// A place within a pattern of shifted rows: which stone, and how far its edge is [parts of the stone's size].
struct Masonry {
    uint32_t column, row;
    glm::dvec2 within; // [0,1]
};

Masonry masonry(const glm::dvec2& p, uint32_t columns, uint32_t rows, double shift) {
    const double y = p.y * rows;
    const auto row = static_cast<uint32_t>(y);
    double x = p.x * columns + (row % 2 ? shift : 0.0);
    if (x >= columns) x -= columns;
    const auto column = static_cast<uint32_t>(x);
    return {column, row, {x - column, y - row}};
}

// Returns 1 within a stone and 0 in the joint around it; `joint` is half its width by axis.
double jointOf(const Masonry& at, const glm::dvec2& joint) {
    const glm::dvec2 edge = (0.5 - glm::abs(at.within - 0.5)) / joint;
    return step(0.6, 1.4, std::min(edge.x, edge.y));
}

struct Leaf {
    glm::dvec2 at;
    double size, turn, tone;
};

Leaf leafOf(uint32_t i, uint32_t seed, double size) {
    return {{random(i, 1, seed), random(i, 2, seed)},
            size * (0.7 + 0.6 * random(i, 3, seed)),
            random(i, 4, seed),
            random(i, 5, seed)};
}

// Returns the distance to a leaf's outline, in its lengths: negative inside.
double leafDistance(const Leaf& leaf, const glm::dvec2& p) {
    // A direction by rational functions: a sine would do, but not everywhere with the same last bit.
    const double t = 2.0 * leaf.turn - 1.0, norm = 1.0 + t * t;
    const glm::dvec2 axis((1.0 - t * t) / norm, 2.0 * t / norm);
    const glm::dvec2 d = (p - leaf.at) / leaf.size;
    const glm::dvec2 q(glm::dot(d, axis), axis.x * d.y - axis.y * d.x);
    return std::abs(q.y) - 0.42 * (1.0 - q.x * q.x);
}

// Paints leaves one over the other; `reach` is the radius of the branch.
glm::dvec4 foliage(const glm::dvec2& p, uint32_t count, double size, double reach, uint32_t seed) {
    glm::dvec4 color(0.20, 0.30, 0.10, 0.0);
    for (uint32_t i = 0; i < count; ++i) {
        Leaf leaf = leafOf(i, seed, size);
        leaf.at = 0.5 + (leaf.at - 0.5) * 2.0 * reach;
        if (glm::length(leaf.at - 0.5) > reach || leafDistance(leaf, p) > 0.0) continue;
        const double vein = std::abs(leafDistance(leaf, p) + 0.42) < 0.07 ? 0.85 : 1.0;
        color = glm::dvec4(
            glm::mix(glm::dvec3(0.24, 0.40, 0.12), glm::dvec3(0.50, 0.62, 0.22), leaf.tone) * vein, 1.0);
    }
    return color;
}

} // namespace

Image plasterPicture(const glm::vec3& color, uint32_t seed) {
    return paintImage("Plaster " + std::to_string(seed), kSide, kSide, [&](glm::dvec2 p) {
        const double stain = cloud(p, 4, seed), fine = noise(p * 128.0, 128, 128, seed + 9);
        const double streak = noise({p.x * 24.0, p.y * 2.0}, 24, 2, seed + 10);
        return glm::dvec3(color) * (0.80 + 0.22 * stain + 0.06 * fine + 0.07 * streak);
    });
}

Image ashlarPicture() {
    return paintImage("Ashlar", kSide, kSide, [](glm::dvec2 p) {
        const Masonry at = masonry(p, 2, 4, 0.5);
        const double tone = random(at.column, at.row, 31) - 0.5, rough = cloud(p, 16, 32) - 0.5;
        const glm::dvec3 stone = glm::dvec3(0.80, 0.75, 0.66) * (1.0 + 0.13 * tone + 0.22 * rough);
        return glm::mix(glm::dvec3(0.56, 0.52, 0.46), stone, jointOf(at, {0.012, 0.024}));
    });
}

Image brickPicture() {
    return paintImage("Brick", kSide, kSide, [](glm::dvec2 p) {
        const Masonry at = masonry(p, 4, 8, 0.5);
        const double tone = random(at.column, at.row, 41), rough = cloud(p, 16, 42) - 0.5;
        const glm::dvec3 brick =
            glm::mix(glm::dvec3(0.58, 0.32, 0.24), glm::dvec3(0.72, 0.46, 0.34), tone) * (1.0 + 0.3 * rough);
        return glm::mix(glm::dvec3(0.70, 0.66, 0.60), brick, jointOf(at, {0.04, 0.09}));
    });
}

Image cobblePicture() {
    return paintImage("Cobbles", kSide, kSide, [](glm::dvec2 p) {
        const Masonry at = masonry(p, 8, 12, 0.5);
        const double tone = random(at.column, at.row, 51) - 0.5, rough = cloud(p, 32, 52) - 0.5;
        // They are worn round: darker towards the joints.
        const glm::dvec2 edge = 0.5 - glm::abs(at.within - 0.5);
        const double dome = step(0.0, 0.42, std::min(edge.x, edge.y * 0.8));
        const glm::dvec3 sett =
            glm::dvec3(0.62, 0.59, 0.55) * (0.72 + 0.28 * dome + 0.24 * tone + 0.25 * rough);
        return glm::mix(glm::dvec3(0.34, 0.31, 0.27), sett, jointOf(at, {0.05, 0.06}));
    });
}

Image flagPicture() {
    return paintImage("Flagstones", kSide, kSide, [](glm::dvec2 p) {
        const Masonry at = masonry(p, 2, 3, 0.43);
        const double tone = random(at.column, at.row, 61) - 0.5, rough = cloud(p, 12, 62) - 0.5;
        const glm::dvec3 slab = glm::dvec3(0.70, 0.67, 0.61) * (1.0 + 0.16 * tone + 0.26 * rough);
        return glm::mix(glm::dvec3(0.42, 0.39, 0.34), slab, jointOf(at, {0.012, 0.018}));
    });
}

Image rooftilePicture() {
    return paintImage("Roof tiles", kSide, kSide, [](glm::dvec2 p) {
        const Masonry at = masonry(p, 8, 6, 0.0);
        const double tone = random(at.column, at.row, 71), rough = cloud(p, 16, 72) - 0.5;
        const double round = 0.72 + 0.28 * step(0.0, 0.5, 0.5 - std::abs(at.within.x - 0.5));
        const double lap = 0.62 + 0.38 * step(1.0, 0.86, at.within.y);
        const glm::dvec3 tile = glm::mix(glm::dvec3(0.62, 0.34, 0.24), glm::dvec3(0.78, 0.50, 0.36), tone);
        return tile * (round * lap * (1.0 + 0.35 * rough));
    });
}

Image boardPicture(const glm::vec3& color) {
    return paintImage("Boards", kSide, kSide, [&](glm::dvec2 p) {
        const Masonry at = masonry(p, 4, 1, 0.0);
        const double tone = random(at.column, 0, 81) - 0.5;
        const double grain = noise({p.x * 96.0, p.y * 4.0}, 96, 4, 82) * 0.6 +
                             noise({p.x * 24.0, p.y * 2.0}, 24, 2, 83) * 0.4 - 0.5;
        const double edge = step(0.0, 0.05, 0.5 - std::abs(at.within.x - 0.5));
        return glm::dvec3(color) * (1.0 + 0.18 * tone + 0.34 * grain) * (0.55 + 0.45 * edge);
    });
}

Image stripePicture() {
    return paintImage("Canvas", 128, 32, [](glm::dvec2 p) {
        const double stripe = step(0.48, 0.52, std::abs(2.0 * p.x - 1.0));
        const double weave = 0.94 + 0.06 * noise({p.x * 64.0, p.y * 16.0}, 64, 16, 91);
        return glm::mix(glm::dvec3(0.90, 0.87, 0.80), glm::dvec3(0.72, 0.20, 0.16), stripe) * weave;
    });
}

Image bookPicture() {
    return paintImage("Books", kSide, 64, [](glm::dvec2 p) {
        const Masonry at = masonry(p, 32, 1, 0.0);
        const double height = 0.10 + 0.16 * random(at.column, 1, 95);
        if (p.y < height) return glm::dvec3(0.10, 0.08, 0.06);
        const glm::dvec3 bright[] = {{0.50, 0.16, 0.14}, {0.18, 0.28, 0.42}, {0.22, 0.36, 0.24},
                                     {0.56, 0.44, 0.26}, {0.38, 0.24, 0.18}, {0.62, 0.56, 0.46}};
        const glm::dvec3 back = bright[static_cast<int>(6.0 * random(at.column, 2, 95))];
        const double round = 0.45 + 0.55 * step(0.0, 0.4, 0.5 - std::abs(at.within.x - 0.5));
        const bool isBand = std::abs(p.y - 0.42) < 0.03 || std::abs(p.y - 0.84) < 0.02;
        return (isBand ? glm::dvec3(0.72, 0.60, 0.34) : back) * round;
    });
}

Image grillePicture() {
    return paintMasked("Grille", 128, 128, [](glm::dvec2 p) {
        const glm::dvec2 cell = glm::fract(p * 4.0) - 0.5;
        const double ring = std::abs(glm::length(cell) - 0.30);
        const bool isIron = std::abs(cell.x) > 0.42 || std::abs(cell.y) > 0.46 || ring < 0.055;
        const double tone = 0.26 + 0.05 * noise(p * 32.0, 32, 32, 97);
        return glm::dvec4(tone, tone, 1.04 * tone, isIron ? 1.0 : 0.0);
    });
}

Image rugPicture() {
    return paintImage("Rug", kSide, 128, [](glm::dvec2 p) {
        const glm::dvec2 edge = (0.5 - glm::abs(p - 0.5)) * glm::dvec2(2.0, 1.0);
        const double border = std::min(edge.x, edge.y);
        const glm::dvec2 cell = glm::abs(glm::fract(p * glm::dvec2(12.0, 6.0)) - 0.5);
        const double lozenge = cell.x + cell.y;
        const glm::dvec3 red(0.56, 0.17, 0.14), blue(0.20, 0.24, 0.40), cream(0.82, 0.74, 0.58);
        if (border < 0.03) return cream * 0.9;
        if (border < 0.11) return glm::mix(blue, cream, lozenge < 0.2 ? 1.0 : 0.0);
        return lozenge < 0.16 ? cream : lozenge < 0.30 ? blue : red;
    });
}

Image leafPicture() {
    return paintMasked("Leaves", kSide, kSide, [](glm::dvec2 p) { return foliage(p, 90, 0.085, 0.44, 101); });
}

Image ivyPicture() {
    return paintMasked("Ivy", kSide, kSide, [](glm::dvec2 p) { return foliage(p, 150, 0.075, 0.66, 111); });
}

Image flowerPicture() {
    return paintMasked("Flowers", 128, 128, [](glm::dvec2 p) {
        glm::dvec4 color = foliage(p, 46, 0.12, 0.44, 121);
        for (uint32_t i = 0; i < 16; ++i) {
            const glm::dvec2 at(0.5 + 0.72 * (random(i, 1, 122) - 0.5),
                                0.45 + 0.62 * (random(i, 2, 122) - 0.5));
            const double r = glm::length(p - at) / (0.045 + 0.02 * random(i, 3, 122));
            if (r < 1.0) color = {0.86 - 0.25 * r, 0.18 + 0.1 * random(i, 4, 122), 0.20, 1.0};
        }
        return color;
    });
}

} // namespace relume::generate
