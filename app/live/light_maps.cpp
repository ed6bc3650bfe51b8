#include "app/live/light_maps.h"

#include <utility>

namespace relume {

void LightMaps::begin(MapSource source, KeptLight kept) {
    next_ = std::move(source);
    kept_ = kept;
    changed_.clear();
    drawnVersion_ = 0;
    edited_ = drawnCurrent_ = false;
}

void LightMaps::edited(uint64_t number, const PatchSet& patches) {
    edited_ = true;
    drawnCurrent_ = false;
    MapSource& source = next_.publisher ? next_ : light_;
    if (!source.publisher) return;
    source.bake = number;
    source.publisher->updateUnit(patches);
}

void LightMaps::end() {
    next_ = {};
}

LiveLight LightMaps::ask(Solver& solver, bool current) {
    current_ = current;
    LiveLight live = solver.liveLight();
    changed_.insert(changed_.end(), live.changed.begin(), live.changed.end());
    changed_ = merged(std::move(changed_));
    return live;
}

LightMapStep LightMaps::decide(const LiveLight& live, bool otherOnScreen) const {
    return decideLightMap({.solved = live.light != nullptr,
                           .complete = live.complete,
                           .newer = live.version != drawnVersion_ || (current_ && !drawnCurrent_),
                           .edited = edited_,
                           .bounced = live.bounced,
                           .kept = next_.publisher ? kept_ : KeptLight::None, // its own light is shown else
                           .drawn = light_.publisher != nullptr,
                           .otherOnScreen = otherOnScreen});
}

uint32_t LightMaps::size(LightMapStep step) const {
    return (step == LightMapStep::Draw && next_.publisher ? next_ : light_).publisher->size();
}

MapSource& LightMaps::draw(LightMapStep step, const LiveLight& live) {
    if (step != LightMapStep::Draw) return light_;
    if (next_.publisher) light_ = std::exchange(next_, {});
    edited_ = false;
    std::vector<uint32_t> chunks;
    for (const ChunkRange& range : changed_) {
        for (uint32_t c = range.first; c < range.first + range.count; ++c)
            chunks.push_back(c);
    }
    changed_.clear();
    light_.publisher->update({.values = *live.light, .chunks = chunks, .unit = light_.publisher->unit()});
    drawnVersion_ = live.version;
    drawnCurrent_ = current_;
    return light_;
}

} // namespace relume
