// Walks through a voxel map. It is legal as GLSL and as C++; points are in voxels, so that p lies in voxel
// floor(p). The includer supplies
//   bool voxelSet(ivec3 voxel)   false outside the map

// Tells which voxels a segment passes, in order [Amanatides and Woo 1987].
struct VoxelWalk {
    ivec3 voxel;
    ivec3 way;   // -1, 0 or 1 along each axis
    ivec3 left;  // voxels still to go along each axis; they decide, so no walk misses its end
    vec3 next;   // parameter at which the next voxel along each axis begins
    vec3 stride; // parameter that one voxel along each axis takes
};

const float kNever = 1e30f; // parameter of an axis along which there is nothing more to go

FUNCTION VoxelWalk startWalk(vec3 from, vec3 to) {
    VoxelWalk w;
    w.voxel = ivec3(floor(from));
    ivec3 last = ivec3(floor(to));
    vec3 d = to - from;
    w.way = sign(last - w.voxel);
    w.left = abs(last - w.voxel);
    for (int axis = 0; axis < 3; ++axis) {
        bool moves = w.left[axis] > 0;
        w.stride[axis] = moves ? 1.0f / abs(d[axis]) : kNever;
        float ahead = w.way[axis] > 0 ? float(w.voxel[axis] + 1) - from[axis] : from[axis] - float(w.voxel[axis]);
        w.next[axis] = moves ? ahead * w.stride[axis] : kNever;
    }
    return w;
}

// Goes on to the next voxel; returns false at the end.
FUNCTION bool stepWalk(INOUT(VoxelWalk) w) {
    if (w.next.x <= w.next.y && w.next.x <= w.next.z) {
        if (w.left.x == 0) return false;
        w.voxel.x += w.way.x;
        w.left.x -= 1;
        w.next.x = w.left.x > 0 ? w.next.x + w.stride.x : kNever;
    } else if (w.next.y <= w.next.z) {
        w.voxel.y += w.way.y;
        w.left.y -= 1;
        w.next.y = w.left.y > 0 ? w.next.y + w.stride.y : kNever;
    } else {
        w.voxel.z += w.way.z;
        w.left.z -= 1;
        w.next.z = w.left.z > 0 ? w.next.z + w.stride.z : kNever;
    }
    return true;
}

// So many set voxels in a row at either end of a segment are the patches' own surroundings (a corner of a
// room, a bent surface) and do not block.
const int kEndVoxels = 3;

// Tells whether something stands between two points: a set voxel that is not one of the first or the last few
// in a row.
FUNCTION bool voxelsBlock(vec3 from, vec3 to) {
    VoxelWalk w = startWalk(from, to);
    bool open = false; // came through a free voxel
    int run = 0;       // set voxels in a row
    do {
        if (voxelSet(w.voxel)) {
            run += 1;
            if (run > kEndVoxels) return true;
        } else {
            if (open && run > 0) return true;
            open = true;
            run = 0;
        }
    } while (stepWalk(w));
    return false;
}

// No voxel that a plane of unit normal n touches is farther from it than this [voxels].
FUNCTION float planeClearance(vec3 n) { return abs(n.x) + abs(n.y) + abs(n.z); }

// Returns the point moved along n to at least `clearance` above the plane through p.
FUNCTION vec3 liftedAbove(vec3 point, vec3 p, vec3 n, float clearance) {
    return point + n * max(0.0f, clearance - dot(point - p, n));
}

// Marches as RTRad does: both ends are moved towards each other by 0.07 m, then points are taken at fixed
// shares of the way, the first one included, the last one not. `from` and `to` are in metres; a voxel is
// floor((p - origin) * scale).
FUNCTION bool rtradMarchBlocked(vec3 from, vec3 to, VoxelGrid grid) {
    const float kInset = 0.07f;
    vec3 start = from + normalize(to - from) * kInset;
    vec3 end = to + normalize(start - to) * kInset;
    float stride = 2.0f / float(grid.resolution);
    for (float t = 0.0f; t < 1.0f; t += stride) {
        vec3 p = (start + t * (end - start) - grid.origin) * grid.scale;
        if (voxelSet(ivec3(max(p, vec3(0.0f))))) return true;
    }
    return false;
}
