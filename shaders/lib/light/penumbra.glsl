// Rays towards a light are worth their time where neighbours see it unalike, in its penumbra and at the edge
// of its shadow. Neighbours are the patches of one part of a tile; push.parts, uint per patch, tells it.
// push.penumbra, uvec2 per part, has a bit for each light that one of the first sample pass's rays has
// reached, and one for each that it has not reached; lights share 32 bits.

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Penumbrae { uvec2 items[]; };

bool inPenumbra(uint patchIndex) {
    uvec2 lights = Penumbrae(push.penumbra).items[WORD_AT(push.parts, patchIndex)];
    return (lights.x & lights.y) != 0u;
}
