#include "assets/generate/shapes/scene_builder.h"
#include "assets/generate/shapes/furniture.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/shapes/shapes.h"

#include <algorithm>
#include <cmath>

// The statue is a winged figure after the idea of the thesis' Lucy, with folds and feathers that shade each
// other.
namespace relume::generate {
namespace {

// Returns a point of the Catmull-Rom curve through `points`; x goes from 0 to 1.
template<class Vector>
Vector through(const std::vector<Vector>& points, double x) {
    const int last = static_cast<int>(points.size()) - 1;
    const double at = std::clamp(x, 0.0, 1.0) * last;
    const int i = std::min(static_cast<int>(at), last - 1);
    const double t = at - i;
    const Vector a = points[std::max(i - 1, 0)], b = points[i], c = points[i + 1],
                 d = points[std::min(i + 2, last)];
    return b + 0.5 * t * ((c - a) + t * ((2.0 * a - 5.0 * b + 4.0 * c - d) + t * (3.0 * (b - c) + d - a)));
}

// Returns half the width, half the depth and the centre's drift to the side at a height: hem, knees, hips,
// waist, chest, shoulders, neck.
glm::dvec3 girth(double height) {
    static const std::vector<glm::dvec3> kRings = {
        {0.335, 0.315, 0.0},   {0.285, 0.270, 0.006}, {0.250, 0.236, 0.016}, {0.230, 0.212, 0.028},
        {0.216, 0.194, 0.040}, {0.203, 0.178, 0.047}, {0.180, 0.150, 0.046}, {0.140, 0.112, 0.036},
        {0.163, 0.129, 0.022}, {0.186, 0.117, 0.008}, {0.058, 0.056, 0.0},   {0.044, 0.046, 0.0}};
    constexpr double kTop = 1.53; // [m]
    return through(kRings, height / kTop);
}

// Returns how far the cloth stands out: its hanging folds run into one another, deep at the hem and tight at
// the waist.
double folds(double angle, double height) {
    const double hanging =
        0.040 * (1.0 - smooth(0.15, 1.0, height)) + 0.006 * (1.0 - smooth(1.20, 1.36, height));
    const double sway = 0.9 * std::sin(2.3 * height + 0.7);
    const double wide = std::sin(9.0 * angle + 1.9 * height + 1.3 * std::sin(2.0 * angle + sway));
    const double narrow = std::sin(19.0 * angle - 3.1 * height + 1.1 * std::sin(3.0 * angle + 2.0 * sway));
    const double fine = std::sin(37.0 * angle + 5.3 * height);
    // A sash is cloth gathered aslant around the hips.
    const double slant = height - 0.985 - 0.06 * std::sin(angle + 0.6);
    const double sash =
        0.021 * std::exp(-slant * slant / 0.0021) * (1.0 + 0.3 * std::sin(150.0 * slant + 2.0 * angle));
    return hanging * (0.62 * wide + 0.27 * narrow + 0.09 * fine) + sash;
}

Solid robe() {
    constexpr int kColumns = 168, kRows = 56;
    return grid({.columns = kColumns, .rows = kRows, .closedS = true}, [](double s, double t) {
        const double height = 1.53 * (1.0 - t) - 0.013 * t;
        const double angle = 2.0 * kPi * s;
        const glm::dvec3 ring = girth(height);
        const double out = folds(angle, height);
        return glm::dvec3((ring.x + out) * std::sin(angle) + ring.z, height,
                          (ring.y + out) * std::cos(angle) + 0.03 * std::sin(1.9 * height));
    });
}

double bump(double x, double width) {
    return std::exp(-x * x / (width * width));
}

Solid head() {
    const glm::dvec3 centre(0.002, 1.598, 0.038);
    return ball(15, [&](const glm::dvec3& d) {
        glm::dvec3 p = d * glm::dvec3(0.080, 0.112, 0.094);
        const double face = smooth(0.2, 0.75, d.z);
        p.x *= 1.0 - 0.26 * smooth(0.1, -1.0, d.y); // the chin is narrow
        p.z += 0.010 * face * smooth(-0.55, -0.8, d.y);
        const double nose = bump(d.x, 0.15) * smooth(0.30, -0.2, d.y) * smooth(-0.40, -0.22, d.y);
        const double sockets = bump(std::abs(d.x) - 0.34, 0.24) * bump(d.y - 0.04, 0.15);
        p.z += face * (0.013 * nose - 0.006 * sockets);
        // The hair falls in waves, parted in the middle and gathered to a knot behind.
        const double hair = smooth(0.60, 0.44, d.z - 0.42 * d.y) * smooth(-0.62, -0.35, d.y - 0.35 * d.z);
        const double waves = std::sin(16.0 * std::atan2(std::abs(d.x) + 0.05, 0.75 + d.y) + 5.0 * d.z);
        const double knot = bump(d.x, 0.34) * bump(d.y - 0.05, 0.34) * smooth(-0.4, -0.9, d.z);
        return centre + p + d * (hair * (0.013 + 0.0035 * waves) + 0.055 * knot);
    });
}

struct Joint {
    glm::dvec3 position;
    double radius; // [m]
};

// Makes a limb with round ends in one chart.
Solid limb(const std::vector<Joint>& joints, int around, int along) {
    std::vector<glm::dvec4> points;
    for (const Joint& joint : joints)
        points.emplace_back(joint.position, joint.radius);
    return grid({.columns = around, .rows = along, .closedS = true}, [&](double s, double t) {
        // Rows gather at the ends, where the radius goes to 0 as a circle does.
        const double x = 0.5 - 0.5 * std::cos(kPi * t);
        const glm::dvec4 at = through(points, x);
        const glm::dvec3 step(through(points, std::min(x + 0.01, 1.0)) -
                              through(points, std::max(x - 0.01, 0.0)));
        const glm::dvec3 up = -glm::normalize(step);
        const glm::dvec3 front = glm::normalize(glm::cross(glm::dvec3(0.83, 0.31, 0.47), up));
        const glm::dvec3 side = glm::cross(up, front);
        const double end = t == 0.0 || t == 1.0 ? 0.0 : 1.0 - std::pow(std::abs(2.0 * x - 1.0), 6.0);
        const double radius = at.w * std::sqrt(end);
        return glm::dvec3(at) + radius * (std::sin(2.0 * kPi * s) * side + std::cos(2.0 * kPi * s) * front);
    });
}

// Makes a wing; `side` is -1 at the viewer's left. The span s runs from the shoulder to the tip, t once
// around from the leading edge down the front to the trailing edge and up the back.
Solid wing(double side) {
    static const std::vector<glm::dvec2> kLeading = {{0.02, 1.20}, {0.15, 1.45}, {0.27, 1.72}, {0.44, 1.92},
                                                     {0.63, 1.90}, {0.77, 1.66}, {0.88, 1.28}, {0.95, 0.80}};
    static const std::vector<glm::dvec2> kTrailing = {{0.03, 1.05}, {0.10, 1.00}, {0.19, 0.93}, {0.31, 0.84},
                                                      {0.46, 0.76}, {0.63, 0.69}, {0.80, 0.66}, {0.95, 0.80}};
    constexpr double kFeathers = 12.0;
    return grid({.columns = 84, .rows = 34, .closedT = true}, [&](double s, double t) {
        const double span = side > 0 ? s : 1.0 - s;
        const double around = 2.0 * kPi * t;
        const double chord = 0.5 - 0.5 * std::cos(around); // 0 leading, 1 trailing edge
        // There are long feathers below and two rows of shorter ones over them, each a step thicker.
        const double rib = std::abs(std::sin(kPi * kFeathers * span));
        const double cover = std::abs(std::sin(kPi * (1.5 * kFeathers * span + 0.5)));
        const double tip = 1.0 - smooth(0.9, 1.0, span);
        glm::dvec2 flat = glm::mix(through(kLeading, span), through(kTrailing, span), chord);
        const glm::dvec2 fall = glm::normalize(glm::dvec2(0.35 - 0.5 * span, -1.0));
        flat += fall * (0.085 * tip * smooth(0.5, 1.0, chord) * rib);
        const double middle = 0.62 + 0.05 * cover, upper = 0.32 + 0.05 * rib;
        const double steps = 0.013 * smooth(middle + 0.03, middle - 0.03, chord) +
                             0.013 * smooth(upper + 0.03, upper - 0.03, chord);
        const double quills = chord > middle ? 0.014 * rib : 0.009 * cover;
        const double inner = std::min(1.0, 6.0 * chord) * std::min(1.0, 5.0 * (1.0 - chord));
        const double depth = tip * (0.026 * std::sqrt(1.0 - chord) + 0.006 + (steps + quills) * inner);
        const double bow = -0.125 - 0.23 * flat.x + 0.14 * flat.x * flat.x - 0.05 * chord;
        return glm::dvec3(side * flat.x, flat.y, bow + depth * std::sin(around));
    });
}

void addStatueRoom(SceneBuilder& builder) {
    const int plaster = builder.paint("Plaster", {0.72f, 0.70f, 0.66f});
    const int slate = builder.paint("Slate blue", {0.12f, 0.24f, 0.42f});
    const int terracotta = builder.paint("Terracotta", {0.60f, 0.24f, 0.12f});
    const int floor = builder.paint("Floor", {0.42f, 0.37f, 0.32f});
    const int lit = builder.lamp("Ceiling light", {8.4f, 8.1f, 7.4f});
    const glm::dvec3 low(-2.3, 0.0, -2.1), high(2.3, 3.9, 2.9);
    Room walls = room(low, high);
    builder.add("Floor", walls.floor.paint(floor));
    builder.add("Back wall", walls.back.paint(plaster));
    builder.add("Front wall", walls.front.paint(plaster));
    builder.add("Left wall", walls.left.paint(slate));
    builder.add("Right wall", walls.right.paint(terracotta));

    // The light lies in a shaft of the ceiling; opening and shaft share their corners.
    const glm::dvec3 corner(-1.1, high.y, 1.0), x(2.2, 0, 0), z(0, 0, -1.9), rise(0, 0.15, 0);
    const glm::dvec3 size = high - low;
    const glm::dvec2 from((corner.x - low.x) / size.x, (high.z - corner.z) / size.z);
    const glm::dvec2 to((corner.x + x.x - low.x) / size.x, (high.z - corner.z - z.z) / size.z);
    builder.add(
        "Ceiling",
        panelWithOpening({low.x, high.y, high.z}, {size.x, 0, 0}, {0, 0, -size.z}, from, to).paint(plaster));
    const glm::dvec3 top = corner + rise;
    Solid shaft = quad(top + x, -x, -rise);
    shaft.add(quad(top + x + z, -z, -rise)).add(quad(top + z, x, -rise)).add(quad(top, z, -rise));
    builder.add("Light shaft", shaft.paint(plaster));
    builder.add("Ceiling light", quad(top, x, z).paint(lit).denser(1.4));
}

} // namespace

Scene cornellStatue() {
    SceneBuilder builder;
    addStatueRoom(builder);
    const int stone = builder.paint("Stone", {0.50f, 0.47f, 0.43f});
    const int marble = builder.paint("Marble", {0.79f, 0.77f, 0.73f});
    const int brass = builder.paint("Brass", {0.72f, 0.52f, 0.20f});
    const glm::dvec3 place(0.0, 0.0, -0.31);
    builder.add("Plinth", plinth(0.387, 0.742).turnY(9.0).paint(stone), place);

    Solid figure = robe();
    figure.add(head());
    figure.add(wing(1.0)).add(wing(-1.0));
    // Her right arm lifts the globe; the left one rests before the waist.
    figure.add(limb({{{-0.125, 1.325, 0.02}, 0.060},
                     {{-0.220, 1.255, 0.05}, 0.055},
                     {{-0.305, 1.215, 0.155}, 0.047},
                     {{-0.335, 1.345, 0.245}, 0.041},
                     {{-0.325, 1.475, 0.285}, 0.033},
                     {{-0.315, 1.585, 0.300}, 0.040}},
                    18, 30));
    figure.add(limb({{{0.130, 1.325, 0.02}, 0.060},
                     {{0.215, 1.225, 0.015}, 0.056},
                     {{0.250, 1.085, 0.05}, 0.049},
                     {{0.170, 1.055, 0.165}, 0.042},
                     {{0.055, 1.095, 0.205}, 0.033},
                     {{-0.015, 1.130, 0.205}, 0.038}},
                    18, 30));
    const glm::dvec3 onPlinth = place + glm::dvec3(0.0, 0.742, 0.0);
    builder.add("Figure", figure.turnY(14.0).paint(marble).denser(1.6), onPlinth);
    Solid globe = sphere(0.082, 8).move({-0.313, 1.652, 0.303});
    builder.add("Globe", globe.turnY(14.0).paint(brass).denser(1.6), onPlinth);

    builder.camera("Front", {-0.45f, 1.80f, 2.65f}, {0.0f, 1.66f, -0.3f}, 52.0f);
    builder.camera("Close", {0.95f, 2.25f, 1.05f}, {-0.03f, 2.02f, -0.3f}, 48.0f);
    return builder.build();
}

} // namespace relume::generate
