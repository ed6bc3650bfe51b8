#pragma once

#include <array>
#include <functional>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/shapes/solid.h"

// These are the shapes of the generated scenes. Y is up, lengths are in metres and angles in degrees. Fronts
// face outwards unless said otherwise. A shape's charts are chosen so that every triangle covers real texels.
namespace relume::generate {

constexpr double kPi = std::numbers::pi, kTwoPi = 2.0 * kPi;

/// Rises from 0 at `low` and below to 1 at `high` and above, without a bend.
double smooth(double low, double high, double x);

/// Returns a point of a surface by its place in the chart, s to the right and t downwards as seen from the
/// front.
using Surface = std::function<glm::dvec3(double s, double t)>;

struct GridDesc {
    int columns = 1, rows = 1;
    bool closedS = false, closedT = false; // the last column (row) lies on the first
    int pieces = 1;                        // charts next to each other along s
};
/// Makes a surface sampled at (i / columns, j / rows). Places follow the sampled lengths, so texels are even.
Solid grid(const GridDesc& desc, const Surface& surface);

/// Makes a parallelogram; its front is where `down` is clockwise of `right`, that is cross(down, right).
Solid quad(const glm::dvec3& topLeft, const glm::dvec3& right, const glm::dvec3& down);

/// Makes a quad cut at the given fractions, which start with 0 and end with 1, so that neighbours find
/// corners to meet.
Solid panel(const glm::dvec3& topLeft, const glm::dvec3& right, const glm::dvec3& down,
            const std::vector<double>& cutsS, const std::vector<double>& cutsT);

/// Makes a quad with an opening from fraction `from` to `to`, as four charts that meet corner to corner.
Solid panelWithOpening(const glm::dvec3& topLeft, const glm::dvec3& right, const glm::dvec3& down,
                       const glm::dvec2& from, const glm::dvec2& to);

/// Makes a flat convex polygon, counter-clockwise seen from the front, in a chart along `right` and `down`
/// (unit, in plane).
Solid polygon(const std::vector<glm::dvec3>& points, const glm::dvec3& right, const glm::dvec3& down);

/// Holds the inside of a box, each side by itself.
struct Room {
    Solid floor, ceiling, back, front, left, right; // back at low z, left at low x
};
Room room(const glm::dvec3& low, const glm::dvec3& high);

enum class Bottom { Open, Closed };

/// Makes a box on the ground, centred over the origin, with a chart per side.
Solid box(const glm::dvec3& size, Bottom bottom = Bottom::Open);
/// Makes the same in two charts, one of which goes around the sides, for small things.
Solid smallBox(const glm::dvec3& size, Bottom bottom = Bottom::Open);

/// Makes a right prism on the ground over a convex outline of (x, z), counter-clockwise seen from above.
Solid prism(const std::vector<glm::dvec2>& outline, double height, Bottom bottom = Bottom::Open);
std::vector<glm::dvec2> regularPolygon(int corners, double radius, double phase = 0.0);

/// Maps (angle [rad], radius, height) to a point; the default is a figure of revolution about Y.
using LatheMap = std::function<glm::dvec3(double angle, const glm::dvec2& radiusAndHeight)>;
glm::dvec3 revolve(double angle, const glm::dvec2& radiusAndHeight);

/// Makes a figure of revolution in one chart; the profile of (radius, height) goes from top to bottom on the
/// outside.
Solid lathe(const std::vector<glm::dvec2>& profile, int segments, const LatheMap& map = revolve);
/// Makes the flat end of a lathe at the given profile point, facing up or down.
Solid cap(const glm::dvec2& radiusAndHeight, int segments, bool up, const LatheMap& map = revolve);

/// Makes a rectangle with mitred corners lathed around Y. The profile of (distance outside the rectangle,
/// height) goes from inside over the top to outside; `halfSize` is (x, z).
Solid moulding(const glm::dvec2& halfSize, const std::vector<glm::dvec2>& profile);

/// Makes a ball in six square charts of n x n quads: any surface that is given by unit direction.
Solid ball(int n, const std::function<glm::dvec3(const glm::dvec3& direction)>& surface);
Solid sphere(double radius, int n);

/// Makes a ring about Y in one chart, with so many segments around the axis and around the tube.
Solid torus(double radius, double tubeRadius, int segments, int tubeSegments);

/// Turns a thing that points up into one that points towards +Z; its -Z becomes up.
glm::dmat3 layOnWall();

/// Returns the points of an arc of a profile: a quarter circle and the like, from angle to angle [degrees].
std::vector<glm::dvec2> arc(const glm::dvec2& centre, double radius, double fromDegrees, double toDegrees,
                            int steps);

} // namespace relume::generate
