#include "bake/base/chunk_sample_passes.h"

#include "assets/base/error.h"

#include <algorithm>
#include <numeric>

namespace relume {

void ChunkSamplePasses::want(std::span<const uint32_t> samplePasses) {
    ASSERT(samplePasses.size() == wanted_.size());
    std::copy(samplePasses.begin(), samplePasses.end(), wanted_.begin());
}

void ChunkSamplePasses::wantOneMore() {
    for (size_t i = 0; i < done_.size(); ++i)
        wanted_[i] = done_[i] + 1;
}

bool ChunkSamplePasses::pending() const {
    for (size_t i = 0; i < done_.size(); ++i)
        if (wanted_[i] > done_[i]) return true;
    return false;
}

ChunkSamplePasses::Pass ChunkSamplePasses::next(uint32_t most) const {
    Pass pass{
        .first = UINT32_MAX, .count = most, .chunks = std::vector<uint8_t>(done_.size(), 0), .all = true};
    for (size_t i = 0; i < done_.size(); ++i)
        if (wanted_[i] > done_[i]) pass.first = std::min(pass.first, done_[i]);
    for (size_t i = 0; i < done_.size(); ++i) {
        const bool takesPart = done_[i] == pass.first && wanted_[i] > done_[i];
        pass.chunks[i] = takesPart ? 1 : 0;
        pass.all = pass.all && takesPart;
        if (takesPart) pass.count = std::min(pass.count, wanted_[i] - done_[i]);
    }
    return pass;
}

void ChunkSamplePasses::finish(const Pass& pass) {
    for (size_t i = 0; i < done_.size(); ++i)
        if (pass.chunks[i] != 0) done_[i] = pass.first + pass.count;
}

uint32_t ChunkSamplePasses::deepest() const {
    return done_.empty() ? 0 : *std::max_element(done_.begin(), done_.end());
}

uint32_t ChunkSamplePasses::shallowest() const {
    return done_.empty() ? 0 : *std::min_element(done_.begin(), done_.end());
}

uint64_t ChunkSamplePasses::total() const {
    return std::accumulate(done_.begin(), done_.end(), uint64_t{0});
}

} // namespace relume
