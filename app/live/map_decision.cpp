#include "app/live/map_decision.h"

namespace relume {

LightMapStep decideLightMap(const LightMapState& state) {
    const bool due = state.newer || state.edited;
    const bool better = state.kept == KeptLight::Whole    ? state.complete
                        : state.kept == KeptLight::Glance ? state.bounced
                                                          : true;
    if (state.solved && due && better) return LightMapStep::Draw;
    return state.otherOnScreen && state.drawn ? LightMapStep::ShowAgain : LightMapStep::None;
}

InspectedMapStep decideInspectedMap(const InspectedMapState& state) {
    if (state.asked) return InspectedMapStep::Draw;
    if (!state.changed) return InspectedMapStep::None;
    return state.secondsSince < kInspectSeconds ? InspectedMapStep::Wait : InspectedMapStep::Draw;
}

} // namespace relume
