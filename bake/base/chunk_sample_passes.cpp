#include "bake/base/chunk_sample_passes.h"

#include "assets/base/error.h"

#include <algorithm>
#include <numeric>

namespace relume {
namespace {

// Tells whether all are as the first one.
bool allEqual(const std::vector<uint32_t>& values) {
    return std::equal(values.begin() + 1, values.end(), values.begin());
}

} // namespace

void ChunkSamplePasses::want(std::span<const uint32_t> samplePasses) {
    ASSERT(samplePasses.size() == wanted_.size());
    std::copy(samplePasses.begin(), samplePasses.end(), wanted_.begin());
}

void ChunkSamplePasses::wantOneMore() {
    for (size_t i = 0; i < done_.size(); ++i)
        wanted_[i] = done_[i] + 1;
}

// Who wants more than it has makes the difference negative. Loops without branches take several chunks at a
// time.
bool ChunkSamplePasses::pending() const {
    constexpr size_t kAtOnce = 4096;
    constexpr uint32_t kSign = uint32_t{1} << 31;
    for (size_t i = 0; i < done_.size(); i += kAtOnce) {
        const size_t end = std::min(i + kAtOnce, done_.size());
        uint32_t differences = 0;
        for (size_t k = i; k < end; ++k)
            differences |= done_[k] - wanted_[k];
        if ((differences & kSign) != 0) return true;
    }
    return false;
}

// Mostly all chunks have and want the same: that is seen in a fraction of the time that looking at each
// takes.
ChunkSamplePasses::Pass ChunkSamplePasses::next(uint32_t most) const {
    const size_t chunks = done_.size();
    Pass pass{.first = UINT32_MAX, .count = most, .chunks = std::vector<uint8_t>(chunks, 1), .all = true};
    if (chunks > 0 && wanted_[0] > done_[0] && allEqual(done_) && allEqual(wanted_)) {
        pass.first = done_[0];
        pass.count = std::min(most, wanted_[0] - done_[0]);
        return pass;
    }
    for (size_t i = 0; i < chunks; ++i)
        if (wanted_[i] > done_[i]) pass.first = std::min(pass.first, done_[i]);
    for (size_t i = 0; i < chunks; ++i) {
        const bool takesPart = done_[i] == pass.first && wanted_[i] > done_[i];
        pass.chunks[i] = takesPart ? 1 : 0;
        pass.all = pass.all && takesPart;
        if (takesPart) pass.count = std::min(pass.count, wanted_[i] - done_[i]);
    }
    return pass;
}

void ChunkSamplePasses::finish(const Pass& pass) {
    const uint32_t now = pass.first + pass.count;
    if (pass.all) return std::fill(done_.begin(), done_.end(), now);
    for (size_t i = 0; i < done_.size(); ++i)
        if (pass.chunks[i] != 0) done_[i] = now;
}

uint32_t ChunkSamplePasses::deepest() const {
    if (done_.empty()) return 0;
    return allEqual(done_) ? done_.front() : *std::max_element(done_.begin(), done_.end());
}

uint32_t ChunkSamplePasses::shallowest() const {
    if (done_.empty()) return 0;
    return allEqual(done_) ? done_.front() : *std::min_element(done_.begin(), done_.end());
}

uint64_t ChunkSamplePasses::total() const {
    return std::accumulate(done_.begin(), done_.end(), uint64_t{0});
}

} // namespace relume
