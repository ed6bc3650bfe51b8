// Tells which voxels a triangle touches. It is legal as GLSL and as C++. Points are in voxels, turned so that
// z is the axis that the triangle faces most.

FUNCTION uint dominantAxis(vec3 normal) {
    vec3 n = abs(normal);
    if (n.x >= n.y && n.x >= n.z) return 0u;
    return n.y >= n.z ? 1u : 2u;
}

FUNCTION vec3 alongAxis(vec3 p, uint axis) {
    return axis == 0u ? vec3(p.y, p.z, p.x) : axis == 1u ? vec3(p.z, p.x, p.y) : p;
}
FUNCTION vec3 fromAxis(vec3 p, uint axis) {
    return axis == 0u ? vec3(p.z, p.x, p.y) : axis == 1u ? vec3(p.y, p.z, p.x) : p;
}

// A voxel that is missed by less than this counts as touched: coordinates of up to 512 voxels are rounded to
// 1/32768.
const float kVoxelSlack = 1.0f / 4096.0f; // voxels
const float kHalfVoxel = 0.5f + 1.0f / 4096.0f;
const float kProductError = 1e-6f; // relative error of a product of three lengths, a few roundings

struct VoxelTriangle {
    vec3 a, b, c;
    vec3 normal;      // of any length
    float planeError; // of a distance to the plane, times that length, per voxel of distance to a
};

FUNCTION VoxelTriangle voxelTriangle(vec3 a, vec3 b, vec3 c) {
    VoxelTriangle t;
    t.a = a;
    t.b = b;
    t.c = c;
    vec3 e = b - a, f = c - a;
    t.normal = cross(e, f);
    t.planeError = kProductError * (abs(e.x) + abs(e.y) + abs(e.z)) * (abs(f.x) + abs(f.y) + abs(f.z));
    return t;
}

FUNCTION float distanceSum(vec3 d) { return abs(d.x) + abs(d.y) + abs(d.z); }

// Returns the lowest and highest z at which the triangle may lie inside the column of pixels around `centre`.
FUNCTION vec2 columnRange(VoxelTriangle t, vec2 centre) {
    float lo = min(t.a.z, min(t.b.z, t.c.z)) - kVoxelSlack, hi = max(t.a.z, max(t.b.z, t.c.z)) + kVoxelSlack;
    vec2 d = centre - vec2(t.a.x, t.a.y);
    float slope = abs(t.normal.z);
    if (slope > 0.0f) {
        float middle = t.a.z - (d.x * t.normal.x + d.y * t.normal.y) / t.normal.z;
        float reach = (kHalfVoxel * (abs(t.normal.x) + abs(t.normal.y)) + t.planeError * (abs(d.x) + abs(d.y))) / slope;
        lo = max(lo, middle - reach - kVoxelSlack);
        hi = min(hi, middle + reach + kVoxelSlack);
    }
    return vec2(lo, hi);
}

// Tells whether the line through p and q and the third corner r, seen along one axis, leave the box around
// the origin aside.
FUNCTION bool edgeSeparates(float px, float py, float qx, float qy, float rx, float ry) {
    float nx = py - qy, ny = qx - px;
    float onEdge = nx * px + ny * py, opposite = nx * rx + ny * ry;
    float reach = kHalfVoxel * (abs(nx) + abs(ny));
    return min(onEdge, opposite) > reach || max(onEdge, opposite) < -reach;
}

// Tells whether triangle and voxel have a point in common, by separating axes [Akenine-Moeller 2001]; the
// voxel is slightly enlarged.
FUNCTION bool touchesVoxel(VoxelTriangle t, vec3 centre) {
    vec3 a = t.a - centre, b = t.b - centre, c = t.c - centre;
    vec3 lo = min(a, min(b, c)), hi = max(a, max(b, c));
    if (lo.x > kHalfVoxel || lo.y > kHalfVoxel || lo.z > kHalfVoxel) return false;
    if (hi.x < -kHalfVoxel || hi.y < -kHalfVoxel || hi.z < -kHalfVoxel) return false;
    if (abs(dot(t.normal, a)) > kHalfVoxel * distanceSum(t.normal) + t.planeError * distanceSum(a)) return false;
    return !(edgeSeparates(a.x, a.y, b.x, b.y, c.x, c.y) || edgeSeparates(b.x, b.y, c.x, c.y, a.x, a.y) ||
             edgeSeparates(c.x, c.y, a.x, a.y, b.x, b.y) || edgeSeparates(a.y, a.z, b.y, b.z, c.y, c.z) ||
             edgeSeparates(b.y, b.z, c.y, c.z, a.y, a.z) || edgeSeparates(c.y, c.z, a.y, a.z, b.y, b.z) ||
             edgeSeparates(a.z, a.x, b.z, b.x, c.z, c.x) || edgeSeparates(b.z, b.x, c.z, c.x, a.z, a.x) ||
             edgeSeparates(c.z, c.x, a.z, a.x, b.z, b.x));
}

// Tells whether the triangle touches the pixel around `centre` in the picture.
FUNCTION bool touchesPixel(VoxelTriangle t, vec2 centre) {
    VoxelTriangle flat_ = t;
    flat_.a = vec3(t.a.x - centre.x, t.a.y - centre.y, 0.0f);
    flat_.b = vec3(t.b.x - centre.x, t.b.y - centre.y, 0.0f);
    flat_.c = vec3(t.c.x - centre.x, t.c.y - centre.y, 0.0f);
    flat_.normal = vec3(0.0f, 0.0f, 1.0f);
    return touchesVoxel(flat_, vec3(0.0f));
}

// Returns the weights of the corners b and c at a point of the picture, moved onto the triangle.
FUNCTION vec2 cornerWeights(VoxelTriangle t, vec2 at) {
    float ex = t.b.x - t.a.x, ey = t.b.y - t.a.y, fx = t.c.x - t.a.x, fy = t.c.y - t.a.y;
    float dx = at.x - t.a.x, dy = at.y - t.a.y, det = ex * fy - ey * fx;
    if (det == 0.0f) return vec2(1.0f / 3.0f, 1.0f / 3.0f);
    float u = max(0.0f, (dx * fy - dy * fx) / det), v = max(0.0f, (ex * dy - ey * dx) / det);
    float w = max(0.0f, 1.0f - (dx * fy - dy * fx) / det - (ex * dy - ey * dx) / det);
    float sum = u + v + w;
    return vec2(u / sum, v / sum);
}

// RTRad draws the box of the scene over resolution x resolution pixels, but counts voxels over a little less.
FUNCTION float rtradPixelsPerVoxel(uint resolution) { return float(resolution) / (float(resolution) - 0.51f); }
