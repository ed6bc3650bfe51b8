#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace relume {

/// Returns the first text that fits, "" where none does. The texts tell the same, the first one the most.
template<typename Fits>
std::string firstThatFits(const std::vector<std::string>& texts, const Fits& fits) {
    const auto found = std::find_if(texts.begin(), texts.end(), fits);
    return found != texts.end() ? *found : "";
}

/// A name beside what it means, by their widths.
struct PairWidth {
    float name = 0, meaning = 0;
};

/// Returns how many pairs stand beside each other in a table, of `most` at most, so that no text is cut off:
/// each column is as wide as its widest text and a gap. It is 1 where not even that fits.
inline size_t pairsInARow(std::span<const PairWidth> pairs, size_t most, float gap, float room) {
    for (size_t count = most; count > 1; --count) {
        std::vector<PairWidth> widest(count);
        for (size_t i = 0; i < pairs.size(); ++i) {
            PairWidth& column = widest[i % count];
            column.name = std::max(column.name, pairs[i].name);
            column.meaning = std::max(column.meaning, pairs[i].meaning);
        }
        float width = 0;
        for (const PairWidth& column : widest)
            width += column.name + column.meaning + 2 * gap;
        if (width <= room) return count;
    }
    return 1;
}

} // namespace relume
