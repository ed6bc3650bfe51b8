// Tells which chunk a workgroup works on: one of a list, or of neighbouring ones. It comes after a push with firstChunk
// and chunks.

// Returns the chunk that has this number in the work.
uint listedChunk(uint number) {
    uint at = push.firstChunk + number;
    return push.chunks != 0ul ? WORD_AT(push.chunks, at) : at;
}
