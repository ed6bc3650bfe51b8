#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/shapes/shapes.h"

// These are walls and what is in their plane. A wall stands in its frame: X along it to the right, Y up, and
// Z towards who looks at it; its surface is at z = 0.
namespace relume::generate {

/// Says where a wall's frame lies in the town: turned by quarters, 0 facing south (+Z), 1 east, 2 north, 3
/// west.
struct Frame {
    glm::dvec3 origin{0.0};
    int quarter = 0;

    double turn() const { return 90.0 * quarter; }
    glm::dvec3 point(const glm::dvec3& local) const;
    Solid put(Solid solid) const;
};

/// Is a rectangular hole in a wall, from its lower left corner to its upper right one [m].
struct Opening {
    glm::dvec2 low{0.0}, high{0.0};
};

/// Makes a wall from `low` to `high` with openings, in one chart whose texture runs in metres.
Solid wall(const glm::dvec2& low, const glm::dvec2& high, const std::vector<Opening>& openings = {});
/// Makes the four sides of an opening, from z = `front` to z = `back`, facing into it.
Solid reveal(const Opening& opening, double front, double back);

/// Makes a strip along a wall from x = `from` to x = `to`. The profile of (distance from the wall, height)
/// goes from top to bottom; both ends are closed.
Solid strip(double from, double to, const std::vector<glm::dvec2>& profile);

struct ArchesDesc {
    double from = 0.0, to = 0.0; // [m] along the wall
    int bays = 1;
    double pier = 0.7; // [m] between two arches; half of it stands at each end
    double springing = 2.5, top = 4.0, thickness = 0.5;
    int steps = 14; // of an arch
};
/// Makes a wall on round arches, from z = 0 to z = -thickness, with its soffits; its ends and its top are
/// open.
Solid arches(const ArchesDesc& desc);
/// Makes the raised bands around its arches.
Solid archBands(const ArchesDesc& desc);

/// Makes a box by two of its corners, with all six sides.
Solid block(const glm::dvec3& low, const glm::dvec3& high);

/// Maps textures onto flat charts by where they are in space, so that neighbours go on from one to the other.
Solid mapped(Solid solid);

} // namespace relume::generate
