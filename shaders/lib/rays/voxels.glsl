// Finds visibility by the voxel map at geometry.accel: what lib/rays/trace.glsl is to the tracers of triangles.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer VoxelGrids { VoxelGrid items[]; };
VoxelGrid grid = VoxelGrids(geometry.accel).items[0];

uint voxelIndex(ivec3 v) { return (uint(v.z) * grid.resolution + uint(v.y)) * grid.resolution + uint(v.x); }

bool voxelInside(ivec3 v) { return all(lessThan(uvec3(v), uvec3(grid.resolution))); }

bool voxelSet(ivec3 v) {
    if (!voxelInside(v)) return false;
    uint i = voxelIndex(v);
    return (WORD_AT(grid.bits, i >> 5) >> (i & 31u) & 1u) != 0u;
}
#include "lib/rays/voxel_walk.glsl"

// Mixed with another tracer, voxels serve one sender in `ratio`, by its texel as RTRad has it, one group of
// samples, one target.
bool voxelsServe(Patch sender) { return patchTexel(sender.flags) % grid.ratio == 0u; }
bool voxelsServeTarget(uint target) { return target % grid.ratio == 0u; }
bool voxelsServeSamples(uint group) { return group % grid.ratio == 0u; }

// Tells whether two patches see each other. Both ends stay clear of the voxels that both patches' planes
// touch; so does then all that lies between them.
bool patchesSee(Patch from, Patch to, bool rtrad) {
    if (rtrad) return !rtradMarchBlocked(from.position, to.position, grid);
    vec3 a = (from.position - grid.origin) * grid.scale, b = (to.position - grid.origin) * grid.scale;
    float clearA = planeClearance(from.normal), clearB = planeClearance(to.normal);
    vec3 start = a + from.normal * clearA, end = b + to.normal * clearB;
    vec3 liftedEnd = liftedAbove(end, a, from.normal, clearA);
    start = liftedAbove(start, b, to.normal, clearB);
    return !voxelsBlock(start, liftedEnd);
}

#ifdef VOXEL_LINKS
// Returns what stands for the surface in a set voxel, as a ray going `direction` meets it: the patch that
// faces the ray most, else kLinkDark for geometry that is no receiver, else kNoPatch.
uint facingPatch(ivec3 voxel, vec3 direction) {
    uint i = voxelIndex(voxel), word = WORD_AT(grid.bits, i >> 5);
    uint rank = WORD_AT(grid.ranks, i >> 5) + uint(bitCount(word & ((1u << (i & 31u)) - 1u)));
    uint found = kNoPatch;
    float most = 0.0;
    for (uint side = 0u; side < kVoxelSides; ++side) {
        uint link = WORD_AT(grid.patches, rank * kVoxelSides + side);
        if (link == kNoPatch) continue;
        if (link == kLinkDark) {
            float along = direction[side >> 1];
            if (found == kNoPatch && ((side & 1u) == 0u ? -along : along) > 0.0) found = kLinkDark;
            continue;
        }
        float facing = -dot(loadPatch(grid.scene, link).normal, direction);
        if (facing > most) {
            most = facing;
            found = link;
        }
    }
    return found;
}

// A target's own surface is that which faces the patch in the target's voxel: the end stays clear of it as of
// a patch's.
bool pointSeen(Patch p, vec3 target) {
    vec3 a = (p.position - grid.origin) * grid.scale, b = (target - grid.origin) * grid.scale;
    float clearA = planeClearance(p.normal);
    vec3 start = a + p.normal * clearA, end = b;
    ivec3 voxel = ivec3(floor(b));
    uint there = voxelSet(voxel) ? facingPatch(voxel, normalize(b - a)) : kNoPatch;
    if (there < kLinkFirstSpecial) {
        vec3 normal = loadPatch(grid.scene, there).normal;
        float clearB = planeClearance(normal);
        end += normal * clearB;
        start = liftedAbove(start, b, normal, clearB);
    }
    return !voxelsBlock(start, liftedAbove(end, a, p.normal, clearA));
}

// Returns what a ray from patch p meets: the first set voxel whose surface faces it. Set voxels in a row at
// the start are the patch's own surroundings: there only what faces the ray counts; later on the back of
// something counts too.
uint voxelLink(Patch p, vec3 direction) {
    vec3 start = (p.position - grid.origin) * grid.scale + p.normal * planeClearance(p.normal);
    // The walk goes up to where the ray leaves the map.
    vec3 far = (mix(vec3(0.0), vec3(grid.resolution), greaterThan(direction, vec3(0.0))) - start) / direction;
    far = mix(far, vec3(kNever), equal(direction, vec3(0.0)));
    float reach = min(far.x, min(far.y, far.z));
    if (reach <= 0.0) return kLinkSky;
    VoxelWalk w = startWalk(start, start + direction * reach);
    bool open = false;
    do {
        if (voxelSet(w.voxel)) {
            uint link = facingPatch(w.voxel, direction);
            if (link != kNoPatch) return link;
            if (open) return kLinkBack;
        } else {
            open = true;
        }
    } while (stepWalk(w));
    return kLinkSky;
}
#endif
