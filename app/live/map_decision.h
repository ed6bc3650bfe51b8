#pragma once

#include <cstdint>

namespace relume {

/// Says how long the light on screen stays when a bake begins.
enum class KeptLight {
    None,
    Glance, // until there is light with bounces
    Whole   // until there is a solution with all of them
};

/// The state of a bake's light and of what is on screen.
struct LightMapState {
    bool solved = false;              // the solver has light to show
    bool complete = false;            // ... a solution with all bounces
    bool newer = false;               // ... that was not drawn yet
    bool edited = false;              // the bake was edited since the newest map, which owes its number
    bool bounced = true;              // ... light with bounces
    KeptLight kept = KeptLight::None; // of the bake before, or of its first glance
    bool drawn = false;               // some light was drawn, of this bake or of the one before
    bool otherOnScreen = false;       // the newest map shows another quantity
};
/// The next map of light.
enum class LightMapStep {
    None,
    Draw,     // the solver's light
    ShowAgain // light as it was drawn before, in place of what was looked at
};
LightMapStep decideLightMap(const LightMapState& state);

/// The state of a quantity that is looked at.
struct InspectedMapState {
    bool asked = false;      // the newest map is of another request, or of another bake
    bool changed = false;    // the quantity follows the light, and this has changed since
    double secondsSince = 0; // the newest map of it
};
/// The next map of such a quantity.
enum class InspectedMapStep {
    None,
    Wait, // for its time
    Draw
};
InspectedMapStep decideInspectedMap(const InspectedMapState& state);

/// The CPU goes through inspected quantities: often enough to follow, seldom enough not to slow the bake.
inline constexpr double kInspectSeconds = 0.2;

} // namespace relume
