// Senders of a list by address.
#include "lib/units.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SenderRuns { Sender items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MemberList { uint items[]; };

// Returns what a chunk of receivers draws by: the texel of its first patch.
uint chunkKey(ADDRESS patches, uint chunk) { return patchTexel(Rows(patches).items[chunk * kChunk * 3u + 2u].w); }

// Returns the patch that stands for a sender before receivers of this key; kNoPatch for padding.
uint drawnMember(ADDRESS senders, ADDRESS members, uint index, uint rowKey) {
    Sender s = SenderRuns(senders).items[index];
    if (s.count == 0u) return kNoPatch;
    return MemberList(members).items[s.first + drawMember(s, rowKey)];
}
