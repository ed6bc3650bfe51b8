#include "bake/base/chunk_order.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstring>

namespace relume {
namespace {

constexpr uint8_t kLeft = 1, kPreferred = 2;

} // namespace

std::vector<ChunkRange> merged(std::vector<ChunkRange> ranges) {
    std::sort(ranges.begin(), ranges.end(),
              [](const ChunkRange& a, const ChunkRange& b) { return a.first < b.first; });
    std::vector<ChunkRange> result;
    for (const ChunkRange& range : ranges) {
        if (result.empty() || range.first > result.back().first + result.back().count) {
            result.push_back(range);
            continue;
        }
        ChunkRange& last = result.back();
        last.count = std::max(last.count, range.first + range.count - last.first);
    }
    return result;
}

std::vector<ChunkRange> rangesOf(const std::vector<uint8_t>& marks, bool marked) {
    std::vector<ChunkRange> ranges;
    for (uint32_t chunk = 0; chunk < marks.size(); ++chunk)
        if ((marks[chunk] != 0) == marked) ranges.push_back({chunk, 1});
    return merged(std::move(ranges));
}

void closeGaps(std::vector<uint8_t>& marks, uint32_t most) {
    uint32_t end = 0; // of the run before; 0: there is none
    for (uint32_t i = 0; i < marks.size(); ++i) {
        if (marks[i] == 0) continue;
        if (end > 0 && i - end <= most) std::fill(marks.begin() + end, marks.begin() + i, uint8_t{1});
        end = i + 1;
    }
}

void ChunkOrder::begin(uint32_t count, const std::vector<uint8_t>& seen) {
    ASSERT(count <= marks_.size());
    std::fill_n(marks_.begin(), count, kLeft);
    std::fill(marks_.begin() + count, marks_.end(), uint8_t{0});
    restore(count, seen);
}

void ChunkOrder::beginMarked(const std::vector<uint8_t>& marks, const std::vector<uint8_t>& seen) {
    ASSERT(marks.size() <= marks_.size());
    std::fill(marks_.begin(), marks_.end(), uint8_t{0});
    std::transform(marks.begin(), marks.end(), marks_.begin(),
                   [](uint8_t mark) { return mark != 0 ? kLeft : uint8_t{0}; });
    restore(static_cast<uint32_t>(marks.size()), seen);
}

void ChunkOrder::restore(uint32_t count, const std::vector<uint8_t>& seen) {
    count_ = count;
    left_ = static_cast<uint32_t>(count - std::count(marks_.begin(), marks_.begin() + count, 0));
    prefer(seen);
}

void ChunkOrder::prefer(const std::vector<uint8_t>& seen) {
    ASSERT(seen.empty() || seen.size() == count_);
    preferred_ = 0;
    if (seen.empty() && std::memchr(marks_.data(), kPreferred, count_) == nullptr) return; // mostly so
    for (uint32_t chunk = 0; chunk < count_; ++chunk) {
        if (marks_[chunk] == 0) continue;
        const bool first = !seen.empty() && seen[chunk] != 0;
        marks_[chunk] = first ? kPreferred : kLeft;
        preferred_ += first;
    }
}

ChunkRange ChunkOrder::next(uint32_t most, uint32_t gap) const {
    if (left_ == 0) return {};
    const void* found = std::memchr(marks_.data(), preferred_ > 0 ? kPreferred : kLeft, count_);
    const auto first = static_cast<uint32_t>(static_cast<const uint8_t*>(found) - marks_.data());
    const uint32_t limit = first + std::min(most, count_ - first);
    uint32_t end = first + 1;
    if (preferred_ == 0) {
        // The last two ranges of a run are of one length: a short one is hardly worth a submit.
        const uint32_t farthest = limit + std::min(most, count_ - limit);
        while (end < farthest && marks_[end] != 0)
            ++end;
        if (end > limit) end = end - limit == most ? limit : first + (end - first + 1) / 2;
        return {first, end - first};
    }
    for (uint32_t chunk = end; chunk < limit && marks_[chunk] != 0 && chunk - end <= gap; ++chunk)
        if (marks_[chunk] == kPreferred) end = chunk + 1;
    return {first, end - first};
}

std::vector<uint32_t> ChunkOrder::nextOnes(uint32_t most) const {
    std::vector<uint32_t> ones;
    const uint8_t wanted = preferred_ > 0 ? kPreferred : kLeft;
    const uint8_t* const marks = marks_.data();
    for (uint32_t chunk = 0; chunk < count_ && ones.size() < most; ++chunk) {
        if (marks[chunk] != wanted) { // what is done may be long
            const void* found = std::memchr(marks + chunk, wanted, count_ - chunk);
            if (found == nullptr) break;
            chunk = static_cast<uint32_t>(static_cast<const uint8_t*>(found) - marks);
        }
        ones.push_back(chunk);
    }
    return ones;
}

void ChunkOrder::finish(std::span<const uint32_t> chunks) {
    for (const uint32_t chunk : chunks)
        finish(ChunkRange{chunk, 1});
}

void ChunkOrder::finish(ChunkRange range) {
    const auto first = marks_.begin() + range.first, end = first + range.count;
    left_ -= range.count - static_cast<uint32_t>(std::count(first, end, uint8_t{0}));
    if (preferred_ > 0) preferred_ -= static_cast<uint32_t>(std::count(first, end, kPreferred));
    std::fill(first, end, uint8_t{0});
}

} // namespace relume
