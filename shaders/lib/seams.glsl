// Places of a texel's 8 neighbours. It is legal as GLSL and as C++ (namespace relume::shader).

// Returns the place of neighbour 0..7: row by row, the texel itself left out.
FUNCTION ivec2 seamOffset(uint neighbour) {
    int place = int(neighbour) + (neighbour >= 4u ? 1 : 0);
    return ivec2(place % 3 - 1, place / 3 - 1);
}
