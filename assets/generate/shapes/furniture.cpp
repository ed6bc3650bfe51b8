#include "assets/generate/shapes/furniture.h"

namespace relume::generate {

Solid globe(double radius, int segments, int rows) {
    std::vector<glm::dvec2> profile = arc({0.0, 0.0}, radius, 90.0, -90.0, rows);
    // The cosine of 90 degrees is not quite 0; poles must be one point.
    profile.front().x = profile.back().x = 0.0;
    return lathe(profile, segments);
}

Solid framedPicture(const glm::dvec2& size, int picture, int frame) {
    const glm::dvec2 half = size / 2.0;
    Solid solid = quad({-half.x, 0.017, -half.y}, {size.x, 0, 0}, {0, 0, size.y}).paint(picture).denser(1.3);
    const std::vector<glm::dvec2> profile = {{-0.003, 0.012}, {-0.003, 0.028}, {0.024, 0.045},
                                             {0.052, 0.041},  {0.063, 0.027},  {0.063, -kSunk}};
    return solid.add(moulding(half, profile).paint(frame));
}

Solid ceilingLight(const glm::dvec2& size, double depth, int lit, int collar) {
    const glm::dvec3 corner(-size.x / 2, -depth, size.y / 2);
    Solid light = quad(corner, {size.x, 0, 0}, {0, 0, -size.y}).paint(lit).denser(2.0);
    // It is turned over: the moulding faces down.
    Solid rim = moulding(size / 2.0, {{0.0, 0.0}, {0.02, 0.004}, {0.02, -depth - kSunk}});
    rim.turn(glm::dmat3({1, 0, 0}, {0, -1, 0}, {0, 0, -1})).move({0, -depth, 0});
    return light.add(rim.paint(collar));
}

Solid plinth(double halfWidth, double height) {
    const double w = halfWidth, h = height;
    const std::vector<glm::dvec2> profile = {{0.031, h},         {0.046, h - 0.007}, {0.046, h - 0.042},
                                             {0.026, h - 0.070}, {0.0, h - 0.087},   {0.0, 0.165},
                                             {0.030, 0.146},     {0.061, 0.112},     {0.061, 0.061},
                                             {0.091, 0.052},     {0.091, -kSunk}};
    Solid solid = moulding({w, w}, profile);
    const double top = w + profile[0].x;
    return solid.add(quad({-top, h, -top}, {2 * top, 0, 0}, {0, 0, 2 * top}));
}

} // namespace relume::generate
