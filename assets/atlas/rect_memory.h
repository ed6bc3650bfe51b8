#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/atlas/rect_pack.h"

namespace relume {

/// Holds where objects with lightmap UVs of their own lay in the atlas of a file, so that what did not change
/// stays there when the file is saved anew. A value: drop it, and the next atlas is packed anew.
struct RectMemory {
    struct Object {
        std::string name;
        uint32_t page = 0;
        PackedRect rect;
    };
    uint32_t size = 0;    // of a page's edge [texels]; 0: nothing is remembered
    uint32_t pages = 0;   // their number
    double density = 0.0; // of the atlas [texels/m]
    std::vector<Object> objects;
};

/// An object that wants a rectangle of this size at the memory's density.
struct WantedRect {
    std::string name;
    uint32_t width = 0, height = 0; // [texels]
};

/// Places of all objects, in their order.
struct RememberedRects {
    std::vector<RectMemory::Object> objects;
    uint32_t coarser = 0;    // objects that have less than they want
    double leastShare = 1.0; // of the texels per metre that it wants, which one of these has
};

/// Leaves each object where one of its name lay, if the rectangle there is about as large as it wants and of
/// its proportions. Others get free places, with half of the texels per metre at the least. `edge` is that of
/// a page without its border. Returns nothing where they do not fit, where many are new, or where little of
/// the atlas is still used: then all is to be packed anew.
std::optional<RememberedRects> placeAgain(const RectMemory& memory, std::span<const WantedRect> wanted,
                                          uint32_t edge, uint32_t gutter);

} // namespace relume
