#include "app/bench/map_sink.h"

namespace relume {

bool MapSink::update() {
    if (const auto offer = exchange_.takeOffer()) {
        if (offer->shared) {
            exchange_.refuse(offer->set);
        } else {
            constexpr size_t kTexelBytes = 8;
            std::array<std::span<std::byte>, LightmapExchange::kSlots> spans;
            for (size_t slot = 0; slot < spans.size(); ++slot) {
                memory_[slot].assign(size_t{offer->size} * offer->size * kTexelBytes, std::byte{0});
                spans[slot] = memory_[slot];
            }
            exchange_.accept(offer->set, spans);
            if (offer->set > 1) exchange_.retire(offer->set - 1);
        }
    }
    const auto map = exchange_.take();
    if (!map) return false;
    if (map_ && map_->set == map->set) exchange_.release(map_->set, map_->slot);
    map_ = map;
    return true;
}

} // namespace relume
