// One word of visibility: patch `lane` of a chunk against up to 32 consecutive targets of its own.
const uint kTargetsPerWord = 32u;

void traceTargets(uint chunk, uint word, uint lane) {
    Patch p = loadPatch(push.patches, (push.firstChunk + chunk) * kChunk + lane);
    vec3 origin = p.position + p.offset * p.normal;
    uint first = word * kTargetsPerWord, count = min(kTargetsPerWord, push.targetCount - first);
    uint seen = 0u, rays = 0u;
    for (uint s = 0u; s < count; ++s) {
        vec4 target = Vec4s(push.targets).items[(chunk * push.targetCount + first + s) * kChunk + lane];
        if (target.w <= 0.0) continue;
        ++rays;
        if (!occluded(Segment(origin, target.xyz - origin, 0.0, 1.0))) seen |= 1u << s;
    }
    if (rays != 0u) atomicAdd(Words(push.rays).items[(push.firstChunk + chunk) % kRayCounters], rays);
    uint words = (push.targetCount + kTargetsPerWord - 1u) / kTargetsPerWord;
    Words(push.bits).items[(chunk * words + word) * kChunk + lane] = seen;
}
