// Traversal of our binary BVH, depth first with a stack. Legal as GLSL and as C++; needs lib/intersect.glsl, and the
// includer supplies
//   BvhNode bvhNode(uint index)
//   BvhTriangle bvhTriangle(uint index)   in the builder's order; .id is the one in WorldMesh order
//   bool solidHit(uint id, float b1, float b2)   the alpha test of a masked triangle

struct BvhHit {
    uint triangle; // in WorldMesh order; kNoPatch: none
    float t;
    float b1, b2;
};

const uint kBvhMasked = 0x80000000u; // bit of BvhTriangle::id

const uint kNoBlocker = 0xffffffffu;

// True if anything solid lies within [tMin, tMax], 0 <= tMin. `blocker` is the triangle that stopped this invocation's last
// blocked ray, in the builder's order (kNoBlocker at first): rays to neighbouring patches are mostly stopped by the same
// one. Children are taken in the tree's order, the likelier one first: sorting them by distance costs more than it saves.
FUNCTION bool bvhAnyHit(vec3 origin, vec3 direction, float tMin, float tMax, INOUT(uint) blocker) {
    BvhRay ray = bvhRay(origin, direction);
    if (blocker != kNoBlocker && intersectTriangle(bvhTriangle(blocker), ray, tMin, tMax).hit) return true;
    int stack[kBvhDepth];
    uint top = 0u;
    int current = 0;
    for (;;) {
        while (current >= 0) {
            BvhNode node = bvhNode(uint(current));
            vec2 r0 = boxRange(node.lo0, node.hi0, ray, tMin, tMax);
            vec2 r1 = boxRange(node.lo1, node.hi1, ray, tMin, tMax);
            bool in0 = r0.x <= r0.y, in1 = r1.x <= r1.y;
            if (!in0 && !in1) {
                if (top == 0u) return false;
                current = stack[--top];
                continue;
            }
            if (in0 && in1) stack[top++] = node.child1;
            current = in0 ? node.child0 : node.child1;
        }
        uint leaf = uint(~current);
        uint end = (leaf >> 3) + (leaf & 7u);
        for (uint i = leaf >> 3; i < end; ++i) {
            BvhTriangle triangle = bvhTriangle(i);
            TriangleHit h = intersectTriangle(triangle, ray, tMin, tMax);
            if (!h.hit) continue;
            if ((triangle.id & kBvhMasked) == 0u) {
                blocker = i;
                return true;
            }
            if (solidHit(triangle.id & ~kBvhMasked, h.b1, h.b2)) return true;
        }
        if (top == 0u) return false;
        current = stack[--top];
    }
}

// The nearest solid hit within [tMin, tMax], 0 <= tMin.
FUNCTION BvhHit bvhClosestHit(vec3 origin, vec3 direction, float tMin, float tMax) {
    BvhRay ray = bvhRay(origin, direction);
    BvhHit best;
    best.triangle = kNoPatch;
    best.t = tMax;
    best.b1 = 0.0f;
    best.b2 = 0.0f;
    int stack[kBvhDepth];
    uint top = 0u;
    int current = 0;
    for (;;) {
        while (current >= 0) {
            BvhNode node = bvhNode(uint(current));
            vec2 r0 = boxRange(node.lo0, node.hi0, ray, tMin, best.t);
            vec2 r1 = boxRange(node.lo1, node.hi1, ray, tMin, best.t);
            bool in0 = r0.x <= r0.y, in1 = r1.x <= r1.y;
            if (!in0 && !in1) {
                if (top == 0u) return best;
                current = stack[--top];
                continue;
            }
            bool first = in0 && (!in1 || r0.x <= r1.x);
            if (in0 && in1) stack[top++] = first ? node.child1 : node.child0;
            current = first ? node.child0 : node.child1;
        }
        uint leaf = uint(~current);
        uint end = (leaf >> 3) + (leaf & 7u);
        for (uint i = leaf >> 3; i < end; ++i) {
            BvhTriangle triangle = bvhTriangle(i);
            TriangleHit h = intersectTriangle(triangle, ray, tMin, best.t);
            if (!h.hit) continue;
            uint id = triangle.id & ~kBvhMasked;
            // Two triangles at one distance: the lower index, whatever the tree's order.
            if (h.t == best.t && id > best.triangle) continue;
            if ((triangle.id & kBvhMasked) != 0u && !solidHit(id, h.b1, h.b2)) continue;
            best.triangle = id;
            best.t = h.t;
            best.b1 = h.b1;
            best.b2 = h.b2;
        }
        if (top == 0u) return best;
        current = stack[--top];
    }
}
