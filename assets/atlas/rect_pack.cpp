#include "assets/atlas/rect_pack.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#include <stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace relume {

bool packRects(std::vector<PackedRect>& rects, uint32_t width, uint32_t height, uint32_t gutter) {
    // Each rectangle carries its gutter on its far sides; at the rim of the atlas that may stick out.
    const int wide = static_cast<int>(width + gutter), high = static_cast<int>(height + gutter);
    std::vector<stbrp_rect> input(rects.size());
    for (size_t i = 0; i < rects.size(); ++i) {
        if (rects[i].width > width || rects[i].height > height) return false;
        input[i].id = static_cast<int>(i);
        input[i].w = static_cast<int>(rects[i].width + gutter);
        input[i].h = static_cast<int>(rects[i].height + gutter);
    }
    std::vector<stbrp_node> nodes(static_cast<size_t>(wide));
    stbrp_context context;
    stbrp_init_target(&context, wide, high, nodes.data(), wide);
    if (!stbrp_pack_rects(&context, input.data(), static_cast<int>(input.size()))) return false;
    for (const stbrp_rect& placed : input) {
        rects[static_cast<size_t>(placed.id)].x = static_cast<uint32_t>(placed.x);
        rects[static_cast<size_t>(placed.id)].y = static_cast<uint32_t>(placed.y);
    }
    return true;
}

} // namespace relume
