#include "assets/images/box_filter.h"

#include "assets/base/portions.h"
#include "assets/base/warnings.h"
#include "assets/images/float_image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

struct Extent {
    uint32_t width = 0, height = 0; // [pixels]
};

/// Tells which pixels of a longer side one of a shorter side covers: those in the middle as a whole, and
/// those at the ends in part.
struct Cover {
    Cover(uint32_t number, uint32_t from, uint32_t to) {
        // Bounds are whole numbers in units of 1 / to of a pixel, so that none is missed.
        const uint64_t begin = uint64_t{number} * from, end = begin + from;
        first = static_cast<uint32_t>(begin / to);
        last = static_cast<uint32_t>((end - 1) / to);
        whole = static_cast<float>(to) / static_cast<float>(from);
        const auto share = [&](uint64_t units) {
            return static_cast<float>(units) / static_cast<float>(from);
        };
        if (first == last) {
            atFirst = atLast = 1.0f;
            return;
        }
        atFirst = share(uint64_t{first + 1} * to - begin);
        atLast = share(end - uint64_t{last} * to);
    }
    float weight(uint32_t at) const { return at == first ? atFirst : at == last ? atLast : whole; }

    uint32_t first = 0, last = 0;
    float whole = 0, atFirst = 0, atLast = 0; // weights, which sum up to 1
};

Extent cutTo(uint32_t most, Extent extent) {
    return {std::min(extent.width, most), std::min(extent.height, most)};
}

/// Calls put(place, mean) for each pixel of the smaller picture; get(place) returns one of the larger
/// picture.
template<typename Get, typename Put>
void filterBoxes(Extent from, Extent to, Get get, Put put) {
    std::vector<Cover> columns;
    columns.reserve(to.width);
    for (uint32_t x = 0; x < to.width; ++x)
        columns.emplace_back(x, from.width, to.width);
    constexpr size_t kRows = 16; // that a thread filters at a time
    WorkerPool pool(std::min(to.height / static_cast<uint32_t>(kRows) + 1, WorkerPool::defaultSize()));
    runPortions(pool, to.height, kRows, [&](size_t begin, size_t end) {
        std::vector<glm::vec4> means(to.width);
        for (size_t y = begin; y < end; ++y) {
            std::fill(means.begin(), means.end(), glm::vec4(0.0f));
            const Cover rows(static_cast<uint32_t>(y), from.height, to.height);
            for (uint32_t row = rows.first; row <= rows.last; ++row)
                for (uint32_t x = 0; x < to.width; ++x) {
                    glm::vec4 mean(0.0f);
                    for (uint32_t column = columns[x].first; column <= columns[x].last; ++column)
                        mean += columns[x].weight(column) * get(size_t{row} * from.width + column);
                    means[x] += rows.weight(row) * mean;
                }
            for (uint32_t x = 0; x < to.width; ++x)
                put(y * to.width + x, means[x]);
        }
    });
}

} // namespace

Image shrunkTo(uint32_t most, const Image& image, bool srgb) {
    const Extent from{image.width, image.height}, to = cutTo(most, from);
    Image small{image.name, to.width, to.height, std::vector<uint8_t>(size_t{4} * to.width * to.height)};
    std::array<float, 256> linear{};
    for (size_t i = 0; i < linear.size(); ++i)
        linear[i] = srgb ? static_cast<float>(linearFromSrgb(static_cast<double>(i) / 255.0))
                         : static_cast<float>(i) / 255.0f;
    const auto byteOf = [](float value) { return static_cast<uint8_t>(std::lround(255.0f * value)); };
    filterBoxes(
        from, to,
        [&](size_t place) {
            const uint8_t* pixel = &image.rgba[4 * place];
            return glm::vec4(linear[pixel[0]], linear[pixel[1]], linear[pixel[2]],
                             static_cast<float>(pixel[3]) / 255.0f);
        },
        [&](size_t place, const glm::vec4& mean) {
            for (glm::length_t c = 0; c < 4; ++c) {
                const float value = std::clamp(mean[c], 0.0f, 1.0f);
                small.rgba[4 * place + static_cast<size_t>(c)] =
                    srgb && c < 3 ? srgbByte(value) : byteOf(value);
            }
        });
    return small;
}

void shrinkTo(uint32_t most, Sky& sky) {
    const Extent from{sky.width, sky.height}, to = cutTo(most, from);
    std::vector<glm::vec3> small(size_t{to.width} * to.height);
    filterBoxes(
        from, to, [&](size_t place) { return glm::vec4(sky.pixels[place], 0.0f); },
        [&](size_t place, const glm::vec4& mean) { small[place] = glm::vec3(mean); });
    sky.width = to.width;
    sky.height = to.height;
    sky.pixels = std::move(small);
}

std::string imageName(const Scene& scene, int image) {
    const std::string& name = scene.images[static_cast<size_t>(image)].name;
    return name.empty() ? fmt::format("image {}", image) : fmt::format("image {} {}", image, inQuotes(name));
}

std::string tooLarge(uint32_t width, uint32_t height, uint32_t most, const char* taker) {
    return fmt::format("has {} x {} pixels, more along a side than the {} that {} takes: it is made smaller "
                       "for it",
                       width, height, most, taker);
}

} // namespace relume
