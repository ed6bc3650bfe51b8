#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/chart_layout.h"

namespace relume {

// Places are given up where so little of the atlas is still used: the file has become another one.
constexpr double kStillUsed = 0.5;
// The shares of its density at which something new is tried to be fitted in, before all else has to move: an
// atlas is as dense as it goes, so that there is room for little.
constexpr double kShares[] = {1.0, 0.85, 0.7, 0.5};

/// The charts of a mesh in the proportions in which instances of it stand in the world, without their size
/// and rotation.
struct UnwrapShape {
    uint64_t hash = 0;               // of positions and indices, and of the UVs where these are kept
    glm::dmat3 factor{1.0};          // from the mesh to the shape
    double texel = 0.0;              // the size of a texel that the charts were cut for [m of the shape]
    bool kept = false;               // one chart: the mesh's own UVs
    bool cutUp = false;              // each triangle is a chart
    std::vector<PlanarChart> charts; // [m of the shape]
};

/// Holds what an unwrap leaves for the next one of the same file, so that what did not change stays where it
/// is: charts of meshes with the same positions and indices, and the places of objects as large as before. A
/// value: drop it, and the next unwrap begins anew.
struct UnwrapMemory {
    struct Object {
        std::string name;
        size_t shape = 0;
        uint32_t page = 0;
        std::vector<ChartPlace> places; // one per chart of the shape
        double share = 1.0;             // of its density, where it came or changed and there was no more room
    };
    uint32_t size = 0;                // of a page [texels]; 0: nothing is remembered
    double asked = 0.0;               // UnwrapDesc::density
    std::vector<ChartLayout> layouts; // of each page, without the places
    std::vector<UnwrapShape> shapes;
    std::vector<Object> objects;
};

} // namespace relume
