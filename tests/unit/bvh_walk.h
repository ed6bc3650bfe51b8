#pragma once

#include <functional>

#include "bake/trace/bvh_builder.h"
#include "tests/unit/trace_world.h"

namespace relume {
namespace shader {

/// Does the shaders' traversal on the CPU, and counts what it is measured by.
struct BvhWalk {
    const Bvh* bvh = nullptr;
    std::function<bool(uint, float, float)> solid = [](uint, float, float) { return true; };
    uint visits = 0;
    BvhNode bvhNode(uint index) {
        ++visits;
        return bvh->nodes.at(index);
    }
    BvhTriangle bvhTriangle(uint index) { return bvh->triangles.at(index); }
    bool solidHit(uint id, float b1, float b2) { return solid(id, b1, b2); }
#include "shaders/lib/rays/intersect.glsl"
#include "shaders/lib/rays/bvh_traverse.glsl"

    BvhHit bruteForce(vec3 origin, vec3 direction, float tMin, float tMax) {
        const BvhRay ray = bvhRay(origin, direction);
        BvhHit best{kNoPatch, tMax, 0, 0};
        for (const BvhTriangle& triangle : bvh->triangles) {
            const TriangleHit h = intersectTriangle(triangle, ray, tMin, best.t);
            const uint id = triangle.id & 0x7fffffffu;
            if (!h.hit || (h.t == best.t && id > best.triangle)) continue;
            if (triangle.id != id && !solid(id, h.b1, h.b2)) continue;
            best = {id, h.t, h.b1, h.b2};
        }
        return best;
    }
};

} // namespace shader

inline TraceScene roomWithSphere(uint32_t cells) {
    TraceWorld world;
    world.addRoom({0, 0, 0}, {4, 3, 5}, 3);
    world.addBumpySphere({2, 1.2f, 2}, 0.8f, cells);
    return world.build();
}

} // namespace relume
