#include "assets/atlas/mask_atlas.h"

#include "assets/base/error.h"

#include <algorithm>
#include <bit>

namespace relume {

namespace {

// A row's longest free run is measured again after so many changes. Until then it may be told too long, which
// costs time alone.
constexpr uint32_t kChanges = 4;

/// Returns the level whose 2^k texels, placed at both ends, cover a run.
uint32_t levelOf(uint32_t length) {
    return static_cast<uint32_t>(std::bit_width(length)) - 1;
}

/// Combines `count` words with those of `from`, shifted down by `shift` bits; one word behind is readable.
void orShifted(uint64_t* to, const uint64_t* from, uint32_t shift, uint32_t count) {
    const uint64_t* first = from + shift / 64;
    const uint32_t bits = shift % 64;
    if (bits == 0) {
        for (uint32_t w = 0; w < count; ++w)
            to[w] |= first[w];
        return;
    }
    for (uint32_t w = 0; w < count; ++w)
        to[w] |= first[w] >> bits | first[w + 1] << (64 - bits);
}

/// Sets the bits [begin, end).
void setBits(uint64_t* words, uint32_t begin, uint32_t end) {
    while (begin < end) {
        const uint32_t bit = begin % 64, count = std::min(64 - bit, end - begin);
        words[begin / 64] |= ~uint64_t{0} >> (64 - count) << bit;
        begin += count;
    }
}

} // namespace

MaskShape::MaskShape(const TexelMask& mask) : width(mask.width()), height(mask.height()), runs(mask.runs()) {
    std::stable_sort(runs.begin(), runs.end(),
                     [](const TexelRun& a, const TexelRun& b) { return a.end - a.begin > b.end - b.begin; });
    // Neighbouring rows are much alike: those far apart tell more.
    std::vector<TexelRun> spread;
    spread.reserve(runs.size());
    if (!runs.empty()) spread.push_back(runs.front());
    for (size_t gap = std::bit_ceil(runs.size()); gap > 1; gap /= 2)
        for (size_t i = gap / 2; i < runs.size(); i += gap)
            spread.push_back(runs[i]);
    runs = std::move(spread);
}

MaskAtlas::MaskAtlas(uint32_t width, uint32_t height)
    : width_(width), height_(height), words_(width / 64 + 2), longestFree_(height, width), changes_(height),
      met_(words_) {
    ASSERT(width > 0 && height > 0);
    // A word behind the last row makes the shifts safe there, too.
    taken_.assign(levelOf(width) + 1, std::vector<uint64_t>(size_t(words_) * height + 2));
}

std::optional<uint32_t> MaskAtlas::freeColumn(const MaskShape& shape, uint32_t y) const {
    const uint32_t columns = width_ - shape.width + 1, words = (columns + 63) / 64;
    std::fill_n(met_.begin(), words, uint64_t{0});
    const uint64_t tail = columns % 64 == 0 ? 0 : ~uint64_t{0} << (columns % 64);
    met_[words - 1] = tail;
    for (const TexelRun& run : shape.runs) {
        const uint32_t length = run.end - run.begin, level = levelOf(length);
        const uint64_t* taken = row(level, y + run.row);
        orShifted(met_.data(), taken, run.begin, words);
        if (length != 1u << level) orShifted(met_.data(), taken, run.end - (1u << level), words);
        uint64_t all = ~uint64_t{0};
        for (uint32_t w = 0; w < words; ++w)
            all &= met_[w];
        if (all == ~uint64_t{0}) return std::nullopt;
    }
    for (uint32_t w = 0; w < words; ++w)
        if (met_[w] != ~uint64_t{0}) return 64 * w + static_cast<uint32_t>(std::countr_one(met_[w]));
    return std::nullopt;
}

std::optional<glm::uvec2> MaskAtlas::lowestPlace(const MaskShape& shape, uint32_t firstRow,
                                                 uint32_t lastRow) const {
    if (shape.width > width_ || shape.height > height_ || shape.runs.empty()) return std::nullopt;
    const TexelRun& longest = shape.runs.front();
    for (uint32_t y = firstRow; y <= std::min(lastRow, height_ - shape.height); ++y) {
        if (longestFree_[y + longest.row] < longest.end - longest.begin) continue;
        if (const std::optional<uint32_t> x = freeColumn(shape, y)) return glm::uvec2(*x, y);
    }
    return std::nullopt;
}

bool MaskAtlas::isFree(const MaskShape& shape, glm::uvec2 place) const {
    if (place.x + shape.width > width_ || place.y + shape.height > height_) return false;
    return std::all_of(shape.runs.begin(), shape.runs.end(), [&](const TexelRun& run) {
        const uint64_t* words = row(0, place.y + run.row);
        for (uint32_t x = place.x + run.begin; x < place.x + run.end; ++x)
            if (words[x / 64] >> (x % 64) & 1u) return false;
        return true;
    });
}

void MaskAtlas::add(const MaskShape& shape, glm::uvec2 place) {
    for (const TexelRun& run : shape.runs) {
        const uint32_t y = place.y + run.row, begin = place.x + run.begin, end = place.x + run.end;
        for (uint32_t level = 0; level < taken_.size(); ++level) {
            const uint32_t reach = (1u << level) - 1; // columns from which the level's texels reach the run
            setBits(taken_[level].data() + size_t(y) * words_, begin - std::min(begin, reach), end);
        }
        if (++changes_[y] % kChanges == 0) measureRow(y);
    }
}

void MaskAtlas::measureRow(uint32_t y) {
    uint32_t longest = 0, begin = 0; // of a free run
    const uint64_t* words = row(0, y);
    for (uint32_t x = 0; x < width_;) {
        const uint64_t rest = words[x / 64] >> (x % 64);
        if (rest & 1u) {
            longest = std::max(longest, x - begin);
            x += static_cast<uint32_t>(std::countr_one(rest));
            begin = x;
        } else {
            x += std::min(static_cast<uint32_t>(std::countr_zero(rest)), 64 - x % 64);
        }
    }
    longestFree_[y] = begin < width_ ? std::max(longest, width_ - begin) : longest;
}

} // namespace relume
