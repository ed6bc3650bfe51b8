// Tells which patches take part in the sample passes of direct light that are taken together; with
// push.penumbra 0, or notes of each patch (lib/light/light_notes.glsl), all do.
#include "lib/light/penumbra.glsl"
#include "lib/light/light_notes.glsl"

// Returns how many of these sample passes the patch takes: the first ones. The very first one is for all, and other
// invocations of its kernels write the notes meanwhile.
uint takenSamplePasses(uint patchIndex) {
    if (push.penumbra == 0ul || push.parts == 0ul || push.samplePass == 0u || inPenumbra(patchIndex)) return push.together;
    return allTakeSamplePass(push.samplePass * push.together) ? 1u : 0u; // no other one of them is for all
}

// Notes in the first sample pass what the others are to do; bit i is for the lights i % 32.
void noteLights(uint patchIndex, uint reached, uint hidden) {
    if (push.penumbra == 0ul || push.samplePass != 0u) return;
    if (push.parts == 0ul) {
        takeNote(patchIndex, reached, hidden);
        return;
    }
    uint part = WORD_AT(push.parts, patchIndex);
    uvec2 lights = Penumbrae(push.penumbra).items[part];
    if ((reached & ~lights.x) != 0u) atomicOr(Penumbrae(push.penumbra).items[part].x, reached);
    if ((hidden & ~lights.y) != 0u) atomicOr(Penumbrae(push.penumbra).items[part].y, hidden);
}
