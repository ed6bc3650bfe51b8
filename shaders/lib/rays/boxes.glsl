// Rays and boxes. It is legal as GLSL and as C++; it comes after shared_objects.h.

// Tells whether a ray may meet the box. Rounding is the box's own matter: it is grown by more than that.
FUNCTION bool rayMeetsBox(vec3 origin, vec3 direction, TraceBox box) {
    float near = 0.0f, far = 1e30f;
    for (int axis = 0; axis < 3; ++axis) {
        float d = direction[axis];
        // A ray parallel to a side is far away on both of its sides, or on neither.
        float inverse = 1.0f / (abs(d) < 1e-20f ? 1e-20f : d);
        float a = (box.lo[axis] - origin[axis]) * inverse, b = (box.hi[axis] - origin[axis]) * inverse;
        near = max(near, min(a, b));
        far = min(far, max(a, b));
    }
    return near <= far;
}

// Tells whether anything of the box stands above the plane through p with unit normal n.
FUNCTION bool boxAbove(vec3 p, vec3 n, TraceBox box) {
    vec3 top = vec3(n.x > 0.0f ? box.hi.x : box.lo.x, n.y > 0.0f ? box.hi.y : box.lo.y, n.z > 0.0f ? box.hi.z : box.lo.z);
    return dot(top - p, n) > 0.0f;
}

// Tells whether the bit of a patch is set, of those of its chunk.
FUNCTION bool hasPatch(uvec2 bits, uint lane) { return (((lane < 32u ? bits.x : bits.y) >> (lane % 32u)) & 1u) != 0u; }

// Tells whether a patch has links to be traced: one that sends, or any that is there.
FUNCTION bool asksAgain(Patch p, uint silent) { return (p.flags & kPatchSends) != 0u || (silent != 0u && p.area > 0.0f); }
