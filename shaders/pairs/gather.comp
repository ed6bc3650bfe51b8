// RTL, second half: gathers the light that the patches of one super-row receive from the senders of another,
// as one partial sum per super-block, side and receiver. There is one workgroup per (super-block, side,
// receiving chunk) and one invocation per receiver. Senders are taken chunk by chunk in ascending order: the
// order of the sum never depends on how work was cut.
#version 460
#extension GL_GOOGLE_include_directive : require
#ifdef SOFTWARE
#extension GL_KHR_shader_subgroup_arithmetic : require
#endif
#include "lib/preamble.glsl"
#include "lib/form_factor.glsl"
#include "lib/supers.glsl"
#include "lib/senders.glsl"
layout(push_constant, scalar) uniform Push { GatherPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer EdgeList { PatchEdges items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer BoundsList { ChunkBounds items[]; };

layout(constant_id = 0) const uint kRtrad = 0;   // 1: RTRad's form factor and its clamp of every addend
layout(constant_id = 1) const uint kSenders = 0; // 0: patches, both ways; 1: a list; 2: drawn from it
const uint kSymmetric = 0u, kDrawn = 2u;

layout(local_size_x = 64) in;

const float kPi = 3.14159265358979;
const float kRtradClamp = 0.05;

struct Source {
    vec3 position;
    float area;
    vec3 normal;
    uint texel;
    vec4 radiance; // of all patches that it stands for
    uint index;    // of its edges
};

Source loadSource(uint index, uint rowKey) {
    Source s;
    s.index = index;
    float count = 1.0;
    if (kSenders == kDrawn) {
        s.index = drawnMember(push.senders, push.members, index, rowKey);
        count = float(SenderRuns(push.senders).items[index].count);
        if (s.index == kNoPatch) return Source(vec3(0.0), 0.0, vec3(0.0), 0u, vec4(0.0), 0u);
    }
    Rows rows = Rows(push.senderPatches);
    vec4 a = uintBitsToFloat(rows.items[s.index * 3u]), b = uintBitsToFloat(rows.items[s.index * 3u + 1u]);
    s.position = a.xyz;
    s.normal = b.xyz;
    s.area = b.w;
    s.texel = kRtrad != 0u ? patchTexel(rows.items[s.index * 3u + 2u].w) : 0u;
    s.radiance = count * Vec4s(push.radiance).items[s.index];
    return s;
}

// Returns the disc form A cos cos / (pi r^2 + A) with unnormalised cosines; the bit says that both are
// positive, but the receiver's shading normal may disagree with its geometric one.
float farFactor(Patch receiver, Source s) {
    vec3 d = s.position - receiver.position;
    float r2 = dot(d, d);
    float cosines = max(dot(d, receiver.shading), 0.0) * -dot(d, s.normal);
    return cosines * s.area / (r2 * (kPi * r2 + s.area));
}

float closeFactor(Patch receiver, Source s) {
    vec3 d = s.position - receiver.position;
    if (dot(d, d) > kClosePair * kClosePair * s.area) return farFactor(receiver, s);
    PatchEdges e = EdgeList(push.senderEdges).items[s.index];
    return parallelogramFormFactor(receiver.position, receiver.shading, s.position, e.du, e.dv, s.normal);
}

// RTRad leaves out samples that lie within a window to the right of and below the receiver.
bool inOwnWindow(Patch receiver, Source s) {
    uint texel = patchTexel(receiver.flags);
    uvec2 d = uvec2(s.texel % push.size, s.texel / push.size) - uvec2(texel % push.size, texel / push.size);
    return d.x < push.window && d.y < push.window; // what lies to the left or above wraps around
}

// Returns RTRad's addend: rgb and the weight in a count as one vector, shortened to 0.05.
vec4 rtradAddend(Patch receiver, vec3 albedo, Source s) {
    float f = rtradFormFactor(receiver.position, receiver.shading, s.position, s.normal, s.area, push.distanceFactor);
    vec4 addend = s.radiance * vec4(albedo, 1.0) * (push.reflectivity * f);
    float size = length(addend);
    if (size > kRtradClamp) addend *= kRtradClamp / size;
    return inOwnWindow(receiver, s) ? vec4(0.0) : addend;
}

bool chunksClose(uint receivers, uint senders) {
    ChunkBounds p = BoundsList(push.bounds).items[receivers], q = BoundsList(push.senderBounds).items[senders];
    vec3 gap = max(max(q.lo - p.hi, p.lo - q.hi), vec3(0.0));
    return dot(gap, gap) <= kClosePair * kClosePair * q.size * q.size;
}

#ifdef SOFTWARE
// Reads senders straight from memory, by an index that is the same for all lanes: one load serves them all.
// Those that none of the lanes sees are left out. (Staged in shared memory they would cost 3 times as much.)
vec4 gatherWord(uint first, uint mine, Patch receiver, vec3 albedo, uint rowKey, bool close) {
    vec4 sum = vec4(0.0);
    uint any = subgroupOr(mine);
    // There are two loops, one of them empty: a loop that ends at once is cheap, a branch inside one is not.
    uint closeOnes = close || kRtrad != 0u ? any : 0u, farOnes = any & ~closeOnes;
    while (closeOnes != 0u) {
        int j = findLSB(closeOnes);
        closeOnes &= closeOnes - 1u;
        if (((mine >> j) & 1u) == 0u) continue;
        Source s = loadSource(first + uint(j), rowKey);
        if (kRtrad != 0u) sum += rtradAddend(receiver, albedo, s);
        else sum.rgb += s.radiance.rgb * closeFactor(receiver, s);
    }
    while (farOnes != 0u) {
        int j = findLSB(farOnes);
        farOnes &= farOnes - 1u;
        Source s = loadSource(first + uint(j), rowKey);
        float f = farFactor(receiver, s);
        sum.rgb += s.radiance.rgb * (((mine >> j) & 1u) != 0u ? f : 0.0);
    }
    return sum;
}

vec4 gatherChunk(uint chunk, uvec2 mask, Patch receiver, vec3 albedo, uint rowKey, bool close) {
    vec4 sum = gatherWord(chunk * kChunk, mask.x, receiver, albedo, rowKey, close);
    return sum + gatherWord(chunk * kChunk + 32u, mask.y, receiver, albedo, rowKey, close);
}
#else
shared Source staged[kChunk];

// Each lane loads one sender for all.
vec4 gatherChunk(uint chunk, uvec2 mask, Patch receiver, vec3 albedo, uint rowKey, bool close) {
    uint lane = gl_LocalInvocationID.x;
    Source own = loadSource(chunk * kChunk + lane, rowKey);
    barrier();
    staged[lane] = own;
    barrier();
    vec4 sum = vec4(0.0);
    uint count = (mask.x | mask.y) != 0u ? kChunk : 0u;
    uint closeCount = close || kRtrad != 0u ? count : 0u, farCount = count - closeCount;
    for (uint j = 0u; j < closeCount; ++j) {
        if ((((j < 32u ? mask.x : mask.y) >> (j & 31u)) & 1u) == 0u) continue;
        Source s = staged[j];
        if (kRtrad != 0u) sum += rtradAddend(receiver, albedo, s);
        else sum.rgb += s.radiance.rgb * closeFactor(receiver, s);
    }
    for (uint j = 0u; j < farCount; ++j) {
        Source s = staged[j];
        float f = farFactor(receiver, s);
        sum.rgb += s.radiance.rgb * ((((j < 32u ? mask.x : mask.y) >> (j & 31u)) & 1u) != 0u ? f : 0.0);
    }
    return sum;
}
#endif

// Loads the bits of a unit for this side's receivers: as traced, or transposed.
uvec2 loadMask(SuperBlock super, uint r, uint c, bool direct) {
    uint word = (direct ? r * kSuper + c : c * kSuper + r) * kBlockWords + gl_LocalInvocationID.x * 2u;
    if (!direct) word += gl_WorkGroupID.y * kSuperWords;
    Words bits = direct ? Words(super.bits) : Words(push.transposed);
    return uvec2(bits.items[word], bits.items[word + 1u]);
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    SuperBlock super = loadSuper(push.supers, gl_WorkGroupID.y);
    uint side = gl_WorkGroupID.x / kSuper, r = gl_WorkGroupID.x % kSuper;
    uint receiverSuper = side == 0u ? super.row : super.column, senderSuper = side == 0u ? super.column : super.row;
    uint receiverChunk = receiverSuper * kSuper + r;
    if (receiverChunk >= push.rowCount || (side == 1u && super.row == super.column)) return;

    Patch receiver = loadPairedPatch(push.patches, receiverChunk * kChunk + lane);
    uint rowKey = kSenders == kDrawn ? chunkKey(push.patches, receiverChunk) : 0u;
    vec3 albedo = vec3(0.0);
    if (kRtrad != 0u) albedo = Vec4s(push.albedo).items[receiverChunk * kChunk + lane].rgb;
    vec4 sum = vec4(0.0);
    for (uint c = 0u; c < kSuper; ++c) {
        uint chunk = senderSuper * kSuper + c;
        if (chunk >= push.columnCount) break;
        if (Words(push.sends).items[chunk] == 0u) continue;
        uvec2 mask = loadMask(super, r, c, kSenders != kSymmetric || receiverChunk < chunk);
        sum += gatherChunk(chunk, mask, receiver, albedo, rowKey, chunksClose(receiverChunk, chunk));
    }
    Vec4s(push.partial).items[(gl_WorkGroupID.y * 2u + side) * kSuperPatches + r * kChunk + lane] = sum;
}
