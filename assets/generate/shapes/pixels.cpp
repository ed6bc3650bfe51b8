#include "assets/generate/shapes/pixels.h"

#include "assets/generate/shapes/paint_image.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace relume::generate {
namespace {

constexpr double kPeriod = 6.283185307179586; // of a sine

// Returns 1 inside and 0 outside; the step goes over one or two pixels.
double inside(double distance) {
    return step(0.008, -0.008, distance);
}

glm::dvec3 grain(const glm::dvec2& p) {
    const double lines =
        noise({p.x * 48.0, p.y * 3.0}, 48, 3, 5) * 0.6 + noise({p.x * 96.0, p.y * 5.0}, 96, 5, 6) * 0.4;
    const double broad = noise({p.x * 7.0, p.y * 2.0}, 7, 2, 7);
    return glm::mix(glm::dvec3(0.42, 0.25, 0.15), glm::dvec3(0.62, 0.40, 0.24), 0.55 * lines + 0.45 * broad);
}

glm::dvec3 sunset(glm::dvec2 p) {
    glm::dvec3 sky =
        glm::mix(glm::dvec3(0.16, 0.20, 0.45), glm::dvec3(0.98, 0.62, 0.30), step(0.0, 0.72, p.y));
    const double sun = std::hypot((p.x - 0.64) * 1.333, p.y - 0.52);
    sky = glm::mix(sky, glm::dvec3(1.0, 0.90, 0.62), inside(sun - 0.13));
    const double far = 0.64 + 0.05 * std::sin(7.0 * p.x) + 0.02 * std::sin(19.0 * p.x);
    const double near = 0.80 + 0.06 * std::sin(4.0 * p.x + 2.0);
    sky = glm::mix(sky, glm::dvec3(0.42, 0.22, 0.38), inside(far - p.y));
    return glm::mix(sky, glm::dvec3(0.14, 0.10, 0.20), inside(near - p.y));
}

glm::dvec3 blocks(glm::dvec2 p) {
    const double linesX[] = {0.22, 0.71, 0.88}, linesY[] = {0.18, 0.62, 0.83};
    for (double line : linesX)
        if (std::abs(p.x - line) < 0.016) return glm::dvec3(0.07);
    for (double line : linesY)
        if (std::abs(p.y - line) < 0.016) return glm::dvec3(0.07);
    if (p.x > 0.22 && p.x < 0.71 && p.y > 0.18 && p.y < 0.62) return {0.82, 0.12, 0.10};
    if (p.x < 0.22 && p.y > 0.62) return {0.12, 0.22, 0.62};
    if (p.x > 0.71 && p.y < 0.18) return {0.95, 0.80, 0.18};
    return glm::dvec3(0.92, 0.90, 0.85);
}

glm::dvec3 discs(glm::dvec2 p) {
    const double x = (p.x - 0.5) * 1.333, y = p.y - 0.5;
    const double radius = std::hypot(x, y) * 9.0;
    const double quarter = (x > 0.0 ? 1.0 : 0.0) + (y > 0.0 ? 2.0 : 0.0);
    const glm::dvec3 palette[] = {{0.85, 0.32, 0.20}, {0.95, 0.74, 0.25}, {0.20, 0.45, 0.62},
                                  {0.88, 0.85, 0.78}, {0.30, 0.55, 0.40}, {0.25, 0.16, 0.30}};
    return palette[static_cast<int>(radius + 1.7 * quarter) % 6];
}

glm::dvec3 waves(glm::dvec2 p) {
    glm::dvec3 color(0.90, 0.88, 0.80);
    for (int i = 0; i < 7; ++i) {
        const double height = 0.22 + 0.11 * i + 0.035 * std::sin(kPeriod * p.x * (1.0 + 0.3 * i) + 1.7 * i);
        const glm::dvec3 band = glm::mix(glm::dvec3(0.55, 0.78, 0.80), glm::dvec3(0.05, 0.18, 0.36), i / 6.0);
        color = glm::mix(color, band, inside(height - p.y));
    }
    return color;
}

glm::dvec3 tree(glm::dvec2 p) {
    glm::dvec3 color = glm::mix(glm::dvec3(0.95, 0.86, 0.62), glm::dvec3(0.86, 0.62, 0.42), p.y);
    color = glm::mix(color, glm::dvec3(0.45, 0.32, 0.20), inside(0.86 - p.y));
    color = glm::mix(color, glm::dvec3(0.24, 0.14, 0.10),
                     inside(std::abs(p.x - 0.5 - 0.03 * std::sin(9.0 * p.y)) - 0.03) * inside(0.4 - p.y));
    for (uint32_t i = 0; i < 40; ++i) {
        const glm::dvec2 leaf(0.5 + 0.62 * (random(i, 1, 3) - 0.5), 0.36 + 0.46 * (random(i, 2, 3) - 0.5));
        const double size = 0.035 + 0.05 * random(i, 3, 3);
        const glm::dvec3 tone =
            glm::mix(glm::dvec3(0.75, 0.22, 0.12), glm::dvec3(0.95, 0.62, 0.16), random(i, 4, 3));
        color = glm::mix(color, tone, inside(std::hypot(p.x - leaf.x, (p.y - leaf.y) * 1.333) - size));
    }
    return color;
}

glm::dvec3 night(glm::dvec2 p) {
    glm::dvec3 color = glm::mix(glm::dvec3(0.04, 0.06, 0.20), glm::dvec3(0.20, 0.32, 0.55), p.y);
    for (uint32_t i = 0; i < 26; ++i) {
        const double star = std::hypot(p.x - random(i, 1, 9), (p.y - 0.6 * random(i, 2, 9)) * 1.333);
        color = glm::mix(color, glm::dvec3(0.95, 0.92, 0.70), inside(star - 0.008 - 0.010 * random(i, 3, 9)));
    }
    const double moon = std::hypot(p.x - 0.3, (p.y - 0.25) * 1.333);
    const double bite = std::hypot(p.x - 0.35, (p.y - 0.22) * 1.333);
    color = glm::mix(color, glm::dvec3(0.98, 0.94, 0.78), inside(moon - 0.12) * (1.0 - inside(bite - 0.11)));
    return glm::mix(color, glm::dvec3(0.03, 0.05, 0.10), inside(0.82 + 0.05 * std::sin(8.0 * p.x) - p.y));
}

glm::dvec3 stripes(glm::dvec2 p) {
    const double shift = 0.05 * std::sin(kPeriod * p.y);
    const auto stripe = static_cast<uint32_t>((p.x + shift + 1.0) * 11.0);
    const double tone = random(stripe, 0, 21);
    return {0.25 + 0.7 * tone, 0.30 + 0.5 * random(stripe, 1, 21), 0.75 - 0.5 * tone};
}

struct Work {
    const char* name;
    bool upright;
    glm::dvec3 (*painter)(glm::dvec2);
};
constexpr Work kWorks[kPaintings] = {
    {"Sunset", false, sunset}, {"Blocks", false, blocks}, {"Discs", false, discs},   {"Waves", false, waves},
    {"Tree", true, tree},      {"Night", true, night},    {"Stripes", true, stripes}};

} // namespace

Image floorTiles() {
    return paintImage("Floor tiles", 512, 512, [](glm::dvec2 p) {
        const glm::dvec2 at = p * 4.0;
        const glm::dvec2 cell = glm::floor(at);
        const glm::dvec2 f = glm::abs(at - cell - 0.5);
        const double square = f.x + f.y - 0.79; // positive in the small squares at the corners
        const double edge = std::min(0.5 - std::max(f.x, f.y), std::abs(square) * 0.7);
        const auto x = static_cast<uint32_t>(cell.x), y = static_cast<uint32_t>(cell.y);
        const double cloud = noise(p * 16.0, 16, 16, 1);
        const double tone = 0.05 * (random(x, y, 2) - 0.5) + 0.06 * (cloud - 0.5);
        const glm::dvec3 cream = glm::dvec3(0.80, 0.74, 0.64) + tone;
        const glm::dvec3 dark = glm::dvec3(0.20, 0.24, 0.26) + 0.5 * tone;
        const glm::dvec3 color = glm::mix(cream, dark, step(-0.01, 0.01, square));
        return glm::mix(glm::dvec3(0.48, 0.44, 0.40), color, step(0.012, 0.028, edge));
    });
}

Image woodPanelling() {
    return paintImage("Wood panelling", 256, 256, [](glm::dvec2 p) {
        // This is the distance to the panel's rim; the painter lights the bevel from above.
        const glm::dvec2 f = glm::abs(p - 0.5);
        const double rim = std::min(0.40 - f.x, 0.38 - f.y);
        const glm::dvec3 wood = grain(rim > 0.0 ? glm::dvec2(p.x, p.y) : glm::dvec2(p.y, p.x));
        double shade = 1.0;
        if (rim > 0.0 && rim < 0.05) {
            const bool flat = 0.40 - f.x > 0.38 - f.y;
            shade = flat ? (p.y < 0.5 ? 0.72 : 1.22) : 0.92;
        }
        if (std::abs(rim) < 0.006) shade = 0.55;
        return wood * shade;
    });
}

Image wallpaper() {
    return paintImage("Wallpaper", 256, 256, [](glm::dvec2 p) {
        const double wave = p.x * 4.0 - std::floor(p.x * 4.0);
        const double band = step(0.05, 0.07, wave) * step(0.55, 0.53, wave);
        glm::dvec3 color = glm::mix(glm::dvec3(0.80, 0.76, 0.66), glm::dvec3(0.66, 0.70, 0.62), band);
        if (std::abs(wave - 0.60) < 0.018 || std::abs(wave - 1.0) < 0.018)
            color = glm::dvec3(0.58, 0.50, 0.36);
        const double row = p.y * 4.0 - std::floor(p.y * 4.0);
        const double lozenge = std::abs(wave - 0.30) * 1.6 + std::abs(row - 0.5) - 0.15;
        const double ring = std::abs(lozenge) - 0.025;
        return glm::mix(color, glm::dvec3(0.80, 0.66, 0.40), inside(ring * 0.5));
    });
}

Image painting(int kind) {
    const Work& work = kWorks[kind];
    return paintImage(work.name, work.upright ? 120 : 160, work.upright ? 160 : 120, work.painter);
}

bool isUpright(int kind) {
    return kWorks[kind].upright;
}

} // namespace relume::generate
