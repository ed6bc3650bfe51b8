// A bounce of LANES layers side by side: one read of a link, and of what lies together behind it, serves all of them.
// Gathers their light over links as links.comp, sample by sample of each replicate; where that ends a pass, also what is
// sent next, and how much the light changed. Without links: what they send to begin with. One workgroup per chunk, one
// invocation per patch.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/preamble.glsl"
#include "lib/packed_light.glsl"
layout(push_constant, scalar) uniform Push { BouncePush push; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Lanes { BounceLane items[]; };

layout(local_size_x = 64) in;

shared vec4 terms[LANES][kChunk];

bool has(uint mask, uint lane) { return ((mask >> lane) & 1u) != 0u; }

void gather(uint link, uint q, inout vec3 sums[LANES][kReplicates]) {
    if (link >= kLinkFirstSpecial) return;
#if LANES == 1
    sums[0][q] += unpackLight(UVec2s(push.packed).items[link]);
#else
    for (uint pair = 0u; pair < LANES / 2u; ++pair) {
        uvec4 two = Rows(push.packed).items[link * (LANES / 2u) + pair];
        sums[2u * pair][q] += unpackLight(two.xy);
        sums[2u * pair + 1u][q] += unpackLight(two.zw);
    }
#endif
}

// Of a lane; what its patch sends is no longer read.
void store(BounceLane lane, uint l, uint index, vec3 light, uint flags, vec3 albedo, bool counts) {
    bool from = has(push.from, l);
    if (push.changes != 0ul) {
        vec3 before = Vec4s(from ? lane.lightB : lane.lightA).items[index].rgb, change = light - before;
        float weight = counts ? 1.0 : 0.0;
        terms[l][gl_LocalInvocationID.x] = weight * vec4(dot(change, change), light.r + light.g + light.b, 1.0,
                                                         before.r + before.g + before.b);
    }
    if (push.links != 0ul && has(push.live, l))
        Vec4s(from ? lane.lightA : lane.lightB).items[index] = vec4(light, 1.0);
    vec3 radiance = (flags & kPatchSends) != 0u ? push.reflectivity * albedo * light : vec3(0.0);
    UVec2s(push.sent).items[index * LANES + l] = packLight(radiance);
}

void main() {
    uint chunk = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (chunk >= push.chunkCount) return;
    uint i = gl_LocalInvocationID.x, index = (push.firstChunk + chunk) * kChunk + i;
    vec3 sums[LANES][kReplicates];
    for (uint l = 0u; l < LANES; ++l)
        for (uint q = 0u; q < kReplicates; ++q) sums[l][q] = vec3(0.0);
    Words links = Words(push.links);
    for (uint k = 0u; k < push.sampleCount; k += kReplicates) {
        uint row = (chunk * push.sampleCount + k) * kChunk + i;
        for (uint q = 0u; q < kReplicates; ++q) gather(links.items[row + q * kChunk], q, sums);
    }
    uint flags = 0u;
    vec3 albedo = vec3(0.0);
    if (push.sent != 0ul) {
        flags = loadPatch(push.patches, index).flags;
        albedo = Vec4s(push.albedo).items[index].rgb;
    }
    bool counts = (flags & kPatchSends) != 0u && (flags & kPatchBackSide) == 0u;
    for (uint l = 0u; l < LANES; ++l) {
        BounceLane lane = Lanes(push.lanes).items[l];
        for (uint q = 0u; q < kReplicates; ++q) {
            uint at = q * push.patchCount + index;
            if (push.sums == kMoreSums) sums[l][q] += Vec4s(lane.sums).items[at].rgb;
            if (push.sums != kNoSums && has(push.live, l)) Vec4s(lane.sums).items[at] = vec4(sums[l][q], 0.0);
        }
        if (push.sent == 0ul) continue;
        vec3 light;
        if (push.links != 0ul) {
            vec3 total = sums[l][0] + sums[l][1] + sums[l][2] + sums[l][3];
            light = Vec4s(lane.direct).items[index].rgb + total * push.scale;
        } else {
            light = Vec4s(has(push.from, l) ? lane.lightB : lane.lightA).items[index].rgb;
        }
        store(lane, l, index, light, flags, albedo, counts);
    }
    if (push.changes == 0ul) return;
    barrier();
    if (i >= LANES) return;
    vec4 total = terms[i][0];
    for (uint k = 1u; k < kChunk; ++k) total += terms[i][k];
    Vec4s(push.changes).items[i * push.allChunks + push.firstChunk + chunk] = total;
}
