// Traces one ray by the tracer that this variant was compiled for. `geometry` is the TraceGeometry of the
// push constants.
#ifdef TRACER_QUERY
#extension GL_EXT_ray_query : require
#endif
#ifdef TRACER_PIPELINE
#extension GL_EXT_ray_tracing : require
#endif
#ifdef TRACER_VOXEL
#include "lib/rays/voxels.glsl"
#else
#include "lib/rays/masked.glsl"

struct Hit {
    uint triangle; // kNoPatch: none
    float b1, b2;
};

#ifdef TRACER_BVH
#define PRECISE precise
#include "lib/rays/intersect.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer ThreeRows { uvec4 a, b, c; };
// Returns the rows at base + 48 * index: with an offset of 32 bits, one address stays in one register.
ThreeRows threeRows(ADDRESS base, uint index) { return ThreeRows(base + uint64_t(index * 48u)); }
BvhNode bvhNode(uint index) {
    ThreeRows rows = threeRows(geometry.accel, index);
    uvec4 a = rows.a, b = rows.b, c = rows.c;
    BvhNode node;
    node.centre0 = uintBitsToFloat(a.xyz);
    node.child0 = int(a.w);
    node.centre1 = uintBitsToFloat(b.xyz);
    node.child1 = int(b.w);
    node.extents = c.xyz;
    return node;
}
BvhTriangle bvhTriangle(uint index) {
    ThreeRows rows = threeRows(geometry.triangles, index);
    uvec4 a = rows.a, b = rows.b, c = rows.c;
    BvhTriangle t;
    t.p0 = uintBitsToFloat(a.xyz);
    t.id = a.w;
    t.p1 = uintBitsToFloat(b.xyz);
    t.p2 = uintBitsToFloat(c.xyz);
    return t;
}
#include "lib/rays/bvh_traverse.glsl"

uint lastBlocker = kNoBlocker;
bool occluded(Segment s) { return bvhAnyHit(s.origin, s.direction, s.tMin, s.tMax, lastBlocker); }

Hit closestHit(vec3 origin, vec3 direction) {
    BvhHit found = bvhClosestHit(origin, direction, 0.0, 1e30);
    return Hit(found.triangle, found.b1, found.b2);
}
#endif

#ifdef TRACER_QUERY
bool solidCandidate(rayQueryEXT query) {
    uint triangle = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false)) + geometry.opaqueCount;
    vec2 b = rayQueryGetIntersectionBarycentricsEXT(query, false);
    return solidHit(triangle, b.x, b.y);
}

bool occluded(Segment s) {
    rayQueryEXT query;
    rayQueryInitializeEXT(query, accelerationStructureEXT(geometry.accel), gl_RayFlagsTerminateOnFirstHitEXT, 0xff, s.origin,
                          s.tMin, s.direction, s.tMax);
    while (rayQueryProceedEXT(query)) {
        if (solidCandidate(query)) rayQueryConfirmIntersectionEXT(query);
    }
    return rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT;
}

Hit closestHit(vec3 origin, vec3 direction) {
    rayQueryEXT query;
    rayQueryInitializeEXT(query, accelerationStructureEXT(geometry.accel), 0u, 0xff, origin, 0.0, direction, 1e30);
    while (rayQueryProceedEXT(query)) {
        if (solidCandidate(query)) rayQueryConfirmIntersectionEXT(query);
    }
    if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) return Hit(kNoPatch, 0.0, 0.0);
    uint triangle = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true));
    if (rayQueryGetIntersectionGeometryIndexEXT(query, true) == 1) triangle += geometry.opaqueCount;
    vec2 b = rayQueryGetIntersectionBarycentricsEXT(query, true);
    return Hit(triangle, b.x, b.y);
}
#endif

#ifdef TRACER_PIPELINE
layout(location = 0) rayPayloadEXT Hit hit;

// The miss shader sets the payload to "none"; closest-hit shaders are skipped here, so anything else is a
// hit.
bool occluded(Segment s) {
    hit.triangle = 0u;
    traceRayEXT(accelerationStructureEXT(geometry.accel), gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT,
                0xff, 0, 0, 0, s.origin, s.tMin, s.direction, s.tMax, 0);
    return hit.triangle != kNoPatch;
}

Hit closestHit(vec3 origin, vec3 direction) {
    traceRayEXT(accelerationStructureEXT(geometry.accel), 0u, 0xff, 0, 0, 0, origin, 0.0, direction, 1e30, 0);
    return hit;
}
#endif

// Tells whether patch `to` is seen from patch `from`, which of both is the lower one or RTRad's receiver.
bool patchesSee(Patch from, Patch to, bool rtrad) {
    Segment s = pairSegment(from, to, rtrad);
    return s.tMax <= s.tMin || !occluded(s);
}

// Tells whether nothing stands between patch p and a point off its own surface.
bool pointSeen(Patch p, vec3 target) {
    vec3 origin = p.position + p.offset * p.normal;
    return !occluded(Segment(origin, target - origin, 0.0, 1.0));
}
#endif
