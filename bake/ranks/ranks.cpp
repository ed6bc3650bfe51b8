#include "bake/ranks/ranks.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace relume {
namespace {

constexpr uint32_t kNobody = UINT32_MAX;

class OneProcess final : public Ranks {
public:
    OneProcess() : Ranks(0, 1) {}

private:
    uint32_t least(uint32_t value) override { return value; }
    void gatherAll(std::span<const std::byte> own, std::span<std::byte> all,
                   std::span<const uint64_t>) override {
        if (!own.empty()) std::memcpy(all.data(), own.data(), own.size());
    }
    void exchangeSome(std::span<const Sent>, std::span<const Received>) override {}
    void sumAll(std::span<uint64_t>) override {}
    SharedBlock shareAll(uint64_t) override { return {}; }
};

} // namespace

// Every call begins with a word of each rank, so that one which has failed elsewhere can say so here.
void Ranks::agree() {
    if (!alone() && least(kNobody) != kNobody) throw OtherRankFailed();
}

void Ranks::gather(std::span<const std::byte> own, std::span<std::byte> all,
                   std::span<const uint64_t> sizes) {
    ASSERT(sizes.size() == count_ && own.size() == sizes[rank_]);
    ASSERT(all.size() == std::accumulate(sizes.begin(), sizes.end(), uint64_t{0}));
    agree();
    gatherAll(own, all, sizes);
}

void Ranks::exchange(std::span<const Sent> sent, std::span<const Received> received) {
    agree();
    exchangeSome(sent, received);
}

void Ranks::sum(std::span<uint64_t> values) {
    agree();
    sumAll(values);
}

uint64_t Ranks::sum(uint64_t value) {
    sum(std::span(&value, 1));
    return value;
}

SharedBlock Ranks::share(uint64_t bytes) {
    ASSERT(bytes > 0);
    agree();
    return shareAll(bytes);
}

void Ranks::meet() {
    agree();
}

void Ranks::finish() {
    agree();
}

bool Ranks::fail() {
    return alone() || least(rank_) == rank_;
}

Ranks& oneProcess() {
    static OneProcess one;
    return one;
}

} // namespace relume
