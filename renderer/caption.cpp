#include "renderer/caption.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <stb_easy_font.h>

namespace relume {
namespace {

// These are in units of the font, whose letters are 7 high and whose lines are 12 apart.
constexpr uint32_t kLineUnits = 12, kPaddingUnits = 4;
// There are so many picture rows for each pixel that a unit is wide; a line is then 4 % of the picture's
// height.
constexpr uint32_t kRowsPerUnit = 270;
// This share of the light is left below the letters: sRGB white becomes a third of grey, against which white
// has a contrast of 7 : 1.
constexpr float kBand = 0.1f;
constexpr size_t kBytesPerLetter = 400; // of quads; the font takes about 270
constexpr size_t kVertexBytes = 16;     // three floats and a colour

struct Layout {
    CaptionBox box;
    uint32_t unit = 1; // [pixels]
    std::string text;  // all lines
};

Layout layOut(uint32_t width, uint32_t height, const std::vector<std::string>& lines) {
    Layout layout;
    for (const std::string& line : lines)
        layout.text += (layout.text.empty() ? "" : "\n") + line;
    const auto drawn = [](char letter) { return letter == '\n' || (letter >= ' ' && letter <= '~'); };
    std::replace_if(
        layout.text.begin(), layout.text.end(), [&](char letter) { return !drawn(letter); }, '?');
    layout.unit = std::max(1u, height / kRowsPerUnit);
    const auto textWidth = static_cast<uint32_t>(stb_easy_font_width(layout.text.data()));
    const auto count = static_cast<uint32_t>(lines.size());
    const uint32_t wide = layout.unit * (textWidth + 2 * kPaddingUnits);
    const uint32_t high = layout.unit * (kLineUnits * count + kPaddingUnits);
    layout.box.width = count > 0 ? std::min(width, wide) : 0;
    layout.box.height = count > 0 ? std::min(height, high) : 0;
    layout.box.y = height - layout.box.height;
    return layout;
}

} // namespace

CaptionBox captionBox(uint32_t width, uint32_t height, const std::vector<std::string>& lines) {
    return layOut(width, height, lines).box;
}

void drawCaption(FloatImage& picture, const std::vector<std::string>& lines) {
    Layout layout = layOut(picture.width, picture.height, lines);
    const CaptionBox& box = layout.box;
    std::vector<char> quads(kBytesPerLetter * (layout.text.size() + 1));
    const int count = stb_easy_font_print(kPaddingUnits, kPaddingUnits, layout.text.data(), nullptr,
                                          quads.data(), static_cast<int>(quads.size()));
    for (const char* channel : {"R", "G", "B"}) {
        ASSERT(picture.find(channel) != nullptr);
        const size_t index = static_cast<size_t>(picture.find(channel) - picture.planes.data());
        std::vector<float>& plane = picture.planes[index];
        const auto row = [&](uint32_t y) { return plane.begin() + size_t{box.y + y} * picture.width; };
        for (uint32_t y = 0; y < box.height; ++y)
            std::for_each(row(y), row(y) + box.width, [](float& value) { value *= kBand; });
        for (int i = 0; i < count; ++i) {
            // These are the first and the third corner; x and y are in units, downwards.
            std::array<float, 2> low{}, high{};
            const char* quad = quads.data() + static_cast<size_t>(i) * 4 * kVertexBytes;
            std::memcpy(low.data(), quad, sizeof(low));
            std::memcpy(high.data(), quad + 2 * kVertexBytes, sizeof(high));
            const auto pixel = [&](float units, uint32_t end) {
                return std::min(end, layout.unit * static_cast<uint32_t>(std::max(0.0f, units)));
            };
            for (uint32_t y = pixel(low[1], box.height); y < pixel(high[1], box.height); ++y)
                std::fill(row(y) + pixel(low[0], box.width), row(y) + pixel(high[0], box.width), 1.0f);
        }
    }
}

} // namespace relume
