#include "lib/rays/starts.glsl"

// Traces listed links again: invocation `first` takes every `step`-th one, so that nobody need know how many
// there are.
void retraceLinks(uint first, uint step) {
    Words list = Words(push.list);
    for (uint i = first; i < list.items[0]; i += step) {
        uint at = list.items[1u + i], lane = at % kChunk, local = at / kChunk % push.sampleCount;
        uint chunk = push.firstChunk + at / (kChunk * push.sampleCount);
        Patch p = loadPatch(push.patches, chunk * kChunk + lane);
        uint key = rotationKey(p, loadPatch(push.patches, chunk * kChunk), push.rotation, push.size);
        uint link = kLinkDark;
        uint sampleNumber = push.firstSample + local;
        if (asksAgain(p, push.silent))
            link = linkAround(startingPatch(p, coverOf(chunk * kChunk + lane), sampleNumber), localDirection(key, sampleNumber));
        WORD_AT(push.links, at) = link;
    }
}
