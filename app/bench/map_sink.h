#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "app/live/lightmap_exchange.h"

namespace relume {

/// Stands for the drawing thread where nothing is drawn: it takes every map into memory. The exchange must
/// outlive it, and the bake that writes must have stopped before it goes.
class MapSink {
public:
    explicit MapSink(LightmapExchange& exchange) : exchange_(exchange) {}

    /// Takes the newest map. Returns whether one came.
    bool update();
    /// Returns the map that is held, or nothing where there is none yet.
    const std::optional<PublishedMap>& map() const { return map_; }
    /// Returns the bytes of the map that is held: four 16-bit floats per texel, row by row.
    std::span<const std::byte> texels() const { return memory_[map_->slot]; }

private:
    LightmapExchange& exchange_;
    std::array<std::vector<std::byte>, LightmapExchange::kSlots> memory_;
    std::optional<PublishedMap> map_;
};

} // namespace relume
