// RTL, second half: the light that the patches of one super-row receive from those of another, one partial sum per
// super-block, side and receiver. One workgroup per (super-block, side, receiving chunk), one invocation per receiver.
// Senders are taken chunk by chunk in ascending order: the order of the sum never depends on how work was cut.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/form_factor.glsl"
layout(push_constant, scalar) uniform Push { GatherPush push; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer EdgeList { PatchEdges items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer BoundsList { ChunkBounds items[]; };

layout(constant_id = 0) const uint kShared = 1; // 1: senders staged in shared memory (GPUs); 0: not (software devices)
layout(constant_id = 1) const uint kRtrad = 0;  // 1: RTRad's form factor and its clamp of every addend

layout(local_size_x = 64) in;

shared vec4 sharedPosition[kChunk]; // w: area
shared vec4 sharedNormal[kChunk];
shared vec4 sharedRadiance[kChunk];

const float kPi = 3.14159265358979;
// Pairs nearer than this many patch sizes (sqrt of the area) take the exact form factor: beyond, the disc form is
// within 2 % of it whatever the angle.
const float kClose = 4.0;
const float kRtradClamp = 0.05;

struct Sender {
    vec3 position;
    float area;
    vec3 normal;
    vec4 radiance;
};

Sender loadSender(uint chunk, uint j) {
    Sender s;
    if (kShared != 0u) {
        s.position = sharedPosition[j].xyz;
        s.area = sharedPosition[j].w;
        s.normal = sharedNormal[j].xyz;
        s.radiance = sharedRadiance[j];
    } else {
        Rows rows = Rows(push.patches);
        uint index = (chunk * kChunk + j);
        vec4 a = uintBitsToFloat(rows.items[index * 3u]), b = uintBitsToFloat(rows.items[index * 3u + 1u]);
        s.position = a.xyz;
        s.normal = b.xyz;
        s.area = b.w;
        s.radiance = Vec4s(push.radiance).items[index];
    }
    return s;
}

void stageSenders(uint chunk) {
    if (kShared != 0u) {
        uint lane = gl_LocalInvocationID.x;
        Patch p = loadPatch(push.patches, chunk * kChunk + lane);
        vec4 radiance = Vec4s(push.radiance).items[chunk * kChunk + lane];
        barrier();
        sharedPosition[lane] = vec4(p.position, p.area);
        sharedNormal[lane] = vec4(p.normal, 0.0);
        sharedRadiance[lane] = radiance;
        barrier();
    }
}

// Disc form A cos cos / (pi r^2 + A) with unnormalised cosines; the bit says that both are positive, but the receiver's
// shading normal may disagree with its geometric one.
float farFactor(Patch receiver, Sender s) {
    vec3 d = s.position - receiver.position;
    float r2 = dot(d, d);
    float cosines = max(dot(d, receiver.shading), 0.0) * -dot(d, s.normal);
    return cosines * s.area / (r2 * (kPi * r2 + s.area));
}

float closeFactor(Patch receiver, Sender s, uint index) {
    vec3 d = s.position - receiver.position;
    if (dot(d, d) > kClose * kClose * s.area) return farFactor(receiver, s);
    PatchEdges e = EdgeList(push.edges).items[index];
    return parallelogramFormFactor(receiver.position, receiver.shading, s.position, e.du, e.dv, s.normal);
}

// RTRad: rgb and the weight in a count as one vector, shortened to 0.05.
vec4 rtradAddend(Patch receiver, vec3 albedo, Sender s) {
    float f = rtradFormFactor(receiver.position, receiver.shading, s.position, s.normal, s.area, push.distanceFactor);
    vec4 addend = s.radiance.a * s.radiance * vec4(albedo, 1.0) * (push.reflectivity * f);
    float size = length(addend);
    return size > kRtradClamp ? addend * (kRtradClamp / size) : addend;
}

bool chunksClose(uint a, uint b) {
    ChunkBounds p = BoundsList(push.bounds).items[a], q = BoundsList(push.bounds).items[b];
    vec3 gap = max(max(q.lo - p.hi, p.lo - q.hi), vec3(0.0));
    return dot(gap, gap) <= kClose * kClose * q.size * q.size;
}

bool seen(uvec2 mask, uint j) { return (((j < 32u ? mask.x : mask.y) >> (j & 31u)) & 1u) != 0u; }

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint super = push.firstSuper + gl_WorkGroupID.y;
    uint side = gl_WorkGroupID.x / kSuper, r = gl_WorkGroupID.x % kSuper;
    uvec2 pair = UVec2s(push.supers).items[super];
    uint receiverSuper = side == 0u ? pair.x : pair.y, senderSuper = side == 0u ? pair.y : pair.x;
    uint receiverChunk = receiverSuper * kSuper + r;
    if (receiverChunk >= push.chunkCount || (side == 1u && pair.x == pair.y)) return;

    Patch receiver = loadPatch(push.patches, receiverChunk * kChunk + lane);
    vec3 albedo = vec3(0.0);
    if (kRtrad != 0u) albedo = Vec4s(push.albedo).items[receiverChunk * kChunk + lane].rgb;
    vec4 sum = vec4(0.0);
    for (uint c = 0u; c < kSuper; ++c) {
        uint chunk = senderSuper * kSuper + c;
        if (chunk >= push.chunkCount) break;
        if (Words(push.chunkSends).items[chunk] == 0u) continue;
        stageSenders(chunk);
        bool direct = receiverChunk < chunk;
        uint local = direct ? r * kSuper + c : c * kSuper + r;
        uint unit = super * kSuperBlocks + local;
        uint word = (unit % push.bitsUnits) * kBlockWords + lane * 2u;
        Words bits = direct ? Words(push.bits) : Words(push.transposed);
        uvec2 mask = uvec2(bits.items[word], bits.items[word + 1u]);
        if (kRtrad != 0u) {
            uint count = (mask.x | mask.y) != 0u ? kChunk : 0u;
            for (uint j = 0u; j < count; ++j) {
                if (seen(mask, j)) sum += rtradAddend(receiver, albedo, loadSender(chunk, j));
            }
            continue;
        }
        // Two loops, one of them empty: a loop that ends at once is cheap on every device, a branch inside one is not.
        bool close = chunksClose(receiverChunk, chunk);
        uint count = (mask.x | mask.y) != 0u ? kChunk : 0u;
        uint closeCount = close ? count : 0u, farCount = close ? 0u : count;
        for (uint j = 0u; j < closeCount; ++j) {
            if (!seen(mask, j)) continue;
            Sender s = loadSender(chunk, j);
            sum.rgb += s.radiance.rgb * closeFactor(receiver, s, chunk * kChunk + j);
        }
        for (uint j = 0u; j < farCount; ++j) {
            Sender s = loadSender(chunk, j);
            float f = farFactor(receiver, s);
            sum.rgb += s.radiance.rgb * (seen(mask, j) ? f : 0.0);
        }
    }
    Vec4s(push.partial).items[(gl_WorkGroupID.y * 2u + side) * kSuperPatches + r * kChunk + lane] = sum;
}
