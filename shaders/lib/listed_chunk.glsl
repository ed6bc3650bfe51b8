// Tells which chunk a workgroup works on: one of a list, or of neighbouring ones. It comes after a push with firstChunk
// and chunks; LISTED_INSTEAD is an address of 4 bytes that are there.

// Returns the chunk that has this number in the work.
uint listedChunk(uint number) {
    uint at = push.firstChunk + number;
    return wordIfAny(push.chunks, at, LISTED_INSTEAD, at);
}
