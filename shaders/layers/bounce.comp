// Bounces LANES layers side by side: one read of a link, and of what lies together behind it, serves all of
// them. Gathers their light over links as links.comp does, sample by sample of each replicate; where that
// ends a bounce, it also makes what is sent next, and tells how much the light changed. Without links it
// makes what they send to begin with. There is one workgroup per chunk and one invocation per patch and
// layer: those of a patch lie side by side, so that what they read is one access.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/packed_light.glsl"
#include "lib/relative_change.glsl"
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Lanes { BounceLane items[]; };

// With 1 links bring the sky's light to layers. To look for it in vain would cost a fifth to a third of the time.
layout(constant_id = 0) const uint kSeesSky = 1;

layout(local_size_x = 64 * LANES) in;

shared vec4 terms[LANES][kChunk];

uint i, index; // of the patch, in its chunk and in all
uint l;        // of the layer
BounceLane lane;

bool has(uint mask) { return ((mask >> l) & 1u) != 0u; }
Vec4s lightNow() { return Vec4s(has(push.from) ? lane.lightB : lane.lightA); }
Vec4s lightNext() { return Vec4s(has(push.from) ? lane.lightA : lane.lightB); }

// Gathers over links, on top of the sums of earlier sample passes. Packed light is scaled: so are sums of it,
// until they are whole.
void gather(uint chunk, out vec3 sums[kReplicates]) {
    for (uint q = 0u; q < kReplicates; ++q) {
        sums[q] = vec3(0.0);
        if (push.sums == kMoreSums) sums[q] = kPackScale * VEC4_AT(lane.sums, q * push.patchCount + index).rgb;
    }
    vec3 sky = kSeesSky != 0u ? kPackScale * lane.sky : vec3(0.0);
    for (uint r = 0u; r < push.samplePasses; ++r) {
        Words links = Words(push.links[r]);
        for (uint k = 0u; k < push.sampleCount; k += kReplicates) {
            uint row = (chunk * push.sampleCount + k) * kChunk + i;
            for (uint q = 0u; q < kReplicates; ++q) {
                uint link = WORD_AT(links, row + q * kChunk);
                if (link < kLinkFirstSpecial) sums[q] += unpackScaled(UVEC2_AT(push.packed, link * LANES + l));
                else if (kSeesSky != 0u && link == kLinkSky) sums[q] += sky;
            }
        }
    }
    for (uint q = 0u; q < kReplicates; ++q) sums[q] *= kPackInverse;
}

// Sends the light of a bounce that ends.
void send(vec3 light) {
    uint flags = loadPatch(push.patches, index).flags;
    vec3 albedo = VEC4_AT(push.albedo, index).rgb;
    bool sends = (flags & kPatchSends) != 0u;
    if (push.changes != 0ul) {
        vec3 before = VEC4_AT(lightNow(), index).rgb, change = light - before;
        float weight = patchIsShown(flags) ? 1.0 : 0.0;
        terms[l][i] = weight * vec4(dot(change, change), light.r + light.g + light.b, 1.0, relativeChange(light, change));
    }
    if (push.samplePasses > 0u && has(push.live)) VEC4_AT(lightNext(), index) = vec4(light, 1.0);
    UVEC2_AT(push.sent, index * LANES + l) = packLight(sends ? push.reflectivity * albedo * light : vec3(0.0));
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    i = gl_LocalInvocationID.x / LANES;
    l = gl_LocalInvocationID.x % LANES;
    index = (push.firstChunk + chunk) * kChunk + i;
    lane = Lanes(push.lanes).items[l];
    vec3 sums[kReplicates];
    gather(chunk, sums);
    if (push.sums != kNoSums && has(push.live)) {
        for (uint q = 0u; q < kReplicates; ++q)
            VEC4_AT(lane.sums, q * push.patchCount + index) = vec4(sums[q], 0.0);
    }
    if (push.sent != 0ul) {
        vec3 total = sums[0] + sums[1] + sums[2] + sums[3];
        send(push.samplePasses > 0u ? VEC4_AT(lane.direct, index).rgb + total * push.scale : VEC4_AT(lightNow(), index).rgb);
    }
    if (push.changes == 0ul) return;
    barrier();
    l = gl_LocalInvocationID.x;
    if (l >= LANES) return;
    vec4 total = terms[l][0];
    for (uint k = 1u; k < kChunk; ++k) total += terms[l][k];
    VEC4_AT(push.changes, l * push.allChunks + push.firstChunk + chunk) = total;
}
