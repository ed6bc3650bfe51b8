#include "app/live/lightmap_exchange.h"

#include "assets/base/error.h"

#include <algorithm>

#include <unistd.h>

namespace relume {

void RowRange::add(const RowRange& other) {
    if (other.empty()) return;
    first = empty() ? other.first : std::min(first, other.first);
    end = std::max(end, other.end);
}

LightmapExchange::~LightmapExchange() {
    closeOffer();
}

// Closes the file descriptors of images that nobody took.
void LightmapExchange::closeOffer() {
    if (!offered_) return;
    for (int& fd : offer_.fds) {
        if (fd >= 0) close(fd);
        fd = -1;
    }
}

std::optional<uint32_t> LightmapExchange::find(State state) const {
    for (uint32_t slot = 0; slot < kSlots; ++slot) {
        if (states_[slot] == state) return slot;
    }
    return std::nullopt;
}

void LightmapExchange::offer(const MapOffer& offer) {
    const std::lock_guard lock(mutex_);
    ASSERT(offer.set > offer_.set);
    closeOffer();
    offer_ = offer;
    offered_ = true;
    accepted_ = refused_ = false;
    states_.fill(State::Free);
    memory_ = {};
}

std::optional<uint32_t> LightmapExchange::claim() {
    const std::lock_guard lock(mutex_);
    if (!accepted_ || find(State::Waiting)) return std::nullopt; // once per drawn frame is enough
    const std::optional<uint32_t> slot = find(State::Free);
    if (slot) states_[*slot] = State::Written;
    return slot;
}

std::span<std::byte> LightmapExchange::memory(uint32_t slot) {
    const std::lock_guard lock(mutex_);
    return memory_[slot];
}

void LightmapExchange::publish(const PublishedMap& map) {
    const std::lock_guard lock(mutex_);
    ASSERT(map.set == offer_.set && states_[map.slot] == State::Written);
    states_[map.slot] = State::Waiting;
    waiting_ = map;
}

void LightmapExchange::giveUp(uint32_t slot) {
    const std::lock_guard lock(mutex_);
    ASSERT(states_[slot] == State::Written);
    states_[slot] = State::Free;
}

bool LightmapExchange::retiredBefore(uint32_t set) const {
    const std::lock_guard lock(mutex_);
    return retired_ + 1 >= set;
}

std::optional<MapOffer> LightmapExchange::takeOffer() {
    const std::lock_guard lock(mutex_);
    if (!offered_) return std::nullopt;
    offered_ = false;
    MapOffer taken = offer_;
    offer_.fds.fill(-1);
    return taken;
}

void LightmapExchange::accept(uint32_t set, const std::array<std::span<std::byte>, kSlots>& memory) {
    const std::lock_guard lock(mutex_);
    if (set != offer_.set) return; // another set was offered since
    memory_ = memory;
    accepted_ = true;
}

void LightmapExchange::refuse(uint32_t set) {
    const std::lock_guard lock(mutex_);
    if (set == offer_.set) refused_ = true;
}

bool LightmapExchange::refused() const {
    const std::lock_guard lock(mutex_);
    return refused_;
}

std::optional<PublishedMap> LightmapExchange::take() {
    const std::lock_guard lock(mutex_);
    const std::optional<uint32_t> slot = find(State::Waiting);
    if (!slot) return std::nullopt;
    states_[*slot] = State::Shown;
    return waiting_;
}

void LightmapExchange::release(uint32_t set, uint32_t slot) {
    const std::lock_guard lock(mutex_);
    if (set != offer_.set) return; // its slots are forgotten
    ASSERT(states_[slot] == State::Shown);
    states_[slot] = State::Free;
}

void LightmapExchange::retire(uint32_t set) {
    const std::lock_guard lock(mutex_);
    retired_ = std::max(retired_, set);
}

void LightmapExchange::publish(LayerProbe probe) {
    const std::lock_guard lock(mutex_);
    const auto same = std::find_if(probes_.begin(), probes_.end(),
                                   [&](const LayerProbe& other) { return other.key == probe.key; });
    if (same != probes_.end())
        *same = std::move(probe);
    else
        probes_.push_back(std::move(probe));
}

std::optional<LayerProbe> LightmapExchange::takeProbe() {
    const std::lock_guard lock(mutex_);
    if (probes_.empty()) return std::nullopt;
    LayerProbe oldest = std::move(probes_.front());
    probes_.erase(probes_.begin());
    return oldest;
}

bool LightmapExchange::hasProbe() const {
    const std::lock_guard lock(mutex_);
    return !probes_.empty();
}

} // namespace relume
