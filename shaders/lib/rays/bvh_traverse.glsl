// Traverses our binary BVH, depth first with a stack. It is legal as GLSL and as C++; it needs
// lib/rays/intersect.glsl, and the includer supplies
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
const int kStackEnd = 0x7fffffff; // below all that is on the stack: neither node nor leaf

// Child 0's extents are read with child 1's bits below: they are a little larger.
FUNCTION vec2 enterChild0(BvhNode node, BvhRay ray, float tMin, float tMax) {
    return boxRange(node.centre0, uintBitsToFloat(node.extents), ray, tMin, tMax);
}
FUNCTION vec2 enterChild1(BvhNode node, BvhRay ray, float tMin, float tMax) {
    return boxRange(node.centre1, uintBitsToFloat(node.extents << 16u), ray, tMin, tMax);
}

// Returns true if anything solid lies within [tMin, tMax], 0 <= tMin. `blocker` is the triangle that stopped
// this invocation's last blocked ray, in the builder's order (kNoBlocker at first): rays to neighbouring
// patches are mostly stopped by the same one. Children are taken in the tree's order, the likelier one first:
// sorting them by distance costs more than it saves.
FUNCTION bool bvhAnyHit(vec3 origin, vec3 direction, float tMin, float tMax, INOUT(uint) blocker) {
    BvhRay ray = bvhRay(origin, direction);
    if (blocker != kNoBlocker && intersectTriangle(bvhTriangle(blocker), ray, tMin, tMax).hit) return true;
    int stack[kBvhDepth + 1u];
    stack[0] = kStackEnd;
    uint top = 1u;
    int current = 0;
    for (;;) {
        while (uint(current) < uint(kStackEnd)) {
            BvhNode node = bvhNode(uint(current));
            vec2 r0 = enterChild0(node, ray, tMin, tMax), r1 = enterChild1(node, ray, tMin, tMax);
            bool in0 = r0.x <= r0.y, in1 = r1.x <= r1.y;
            if (!in0 && !in1) {
                current = stack[--top];
                continue;
            }
            if (in0 && in1) stack[top++] = node.child1;
            current = in0 ? node.child0 : node.child1;
        }
        if (current == kStackEnd) return false;
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
        current = stack[--top];
    }
}

// Returns `best`, or what is nearer among a leaf's triangles.
FUNCTION BvhHit nearerInLeaf(uint leaf, BvhRay ray, float tMin, BvhHit best) {
    uint end = (leaf >> 3) + (leaf & 7u);
    for (uint i = leaf >> 3; i < end; ++i) {
        BvhTriangle triangle = bvhTriangle(i);
        TriangleHit h = intersectTriangle(triangle, ray, tMin, best.t);
        if (!h.hit) continue;
        uint id = triangle.id & ~kBvhMasked;
        // The lower index counts where two triangles are at one distance, whatever the tree's order.
        if (h.t == best.t && id > best.triangle) continue;
        if ((triangle.id & kBvhMasked) != 0u && !solidHit(id, h.b1, h.b2)) continue;
        best.triangle = id;
        best.t = h.t;
        best.b1 = h.b1;
        best.b2 = h.b2;
    }
    return best;
}

// Returns the nearest solid hit within [tMin, tMax], 0 <= tMin. The first leaf that a ray comes to is held
// back while it goes on to the next one, so that a GPU's lanes test triangles together [Aila and Laine 2009].
// Any-hit rays would go on in vain.
FUNCTION BvhHit bvhClosestHit(vec3 origin, vec3 direction, float tMin, float tMax) {
    BvhRay ray = bvhRay(origin, direction);
    BvhHit best;
    best.triangle = kNoPatch;
    best.t = tMax;
    best.b1 = 0.0f;
    best.b2 = 0.0f;
    int stack[kBvhDepth + 1u];
    stack[0] = kStackEnd;
    uint top = 1u;
    int current = 0;
    while (current != kStackEnd) {
        int held = 0; // a leaf, if below 0
        while (uint(current) < uint(kStackEnd)) {
            BvhNode node = bvhNode(uint(current));
            vec2 r0 = enterChild0(node, ray, tMin, best.t), r1 = enterChild1(node, ray, tMin, best.t);
            bool in0 = r0.x <= r0.y, in1 = r1.x <= r1.y;
            if (!in0 && !in1) {
                current = stack[--top];
            } else {
                bool first = in0 && (!in1 || r0.x <= r1.x);
                if (in0 && in1) stack[top++] = first ? node.child1 : node.child0;
                current = first ? node.child0 : node.child1;
            }
            if (current < 0 && held >= 0) {
                held = current;
                current = stack[--top];
            }
        }
        while (held < 0) {
            best = nearerInLeaf(uint(~held), ray, tMin, best);
            held = current;
            if (current < 0) current = stack[--top];
        }
    }
    return best;
}
