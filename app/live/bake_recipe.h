#pragma once

#include <string>

#include "app/edit/prepare.h"
#include "bake/baker/baker.h"

namespace relume {

/// The things that a bake in the viewer is made of, beside edits of its scene.
struct BakeRecipe {
    uint64_t surfaces = 0; // as BakeOrders::Start has them; 0: none
    BakeSettings settings; // as bakeable() has them
    uint32_t rings = 4;    // of texels filled around charts, on screen
};

/// Returns settings as a viewer's bake has them: steps of so many milliseconds, light that is asked for all
/// the time, and layers only where the method can have one for each light.
BakeSettings bakeable(BakeSettings typed, double batchMs);

/// Tells in one line why these settings cannot be baked; "" when they can.
std::string settingsProblem(const BakeSettings& settings);

/// Tells whether a bake of the one recipe goes on as one of the other when it is edited. Layers, as they are
/// asked for, are left out: the caller knows whether there are any.
bool differOnlyInEdits(const BakeRecipe& baked, const BakeRecipe& wanted);

/// Tells whether patches and tracer of the one serve for the other, so that only the solver is made anew.
bool samePatches(const BakeSettings& a, const BakeSettings& b);

} // namespace relume
