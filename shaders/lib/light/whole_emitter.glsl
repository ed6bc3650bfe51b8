// The light of all polygons of a mesh light without shadows. It is legal as GLSL and as C++ (namespace relume::shader); it
// comes after lib/light/emitters.glsl. The includer supplies
//   EmitterNode emitterNode(uint index)         of the light tree; 0 is its root
//   EmitterPolygon emitterPolygon(uint index)
//   EmitterEdge emitterEdge(uint index)

// Returns the lighting of a receiver at p [m] of unit normal n, the sum of radiance times exact form factor. Where all
// polygons are above its horizon it is a sum over edges [Lambert 1760]: between two polygons of one radiance that both
// face the receiver, or both do not, an edge counts nothing, so that of a closed mesh the outline is left.
FUNCTION vec3 wholeEmitterLight(vec3 p, vec3 n, uint polygonCount, uint edgeCount) {
    vec3 sum = vec3(0.0f, 0.0f, 0.0f);
    int side = sideOfHorizon(emitterNode(0u), p, n);
    if (side < 0) return sum;
    if (side == 0) {
        for (uint i = 0u; i < polygonCount; ++i) {
            EmitterPolygon e = emitterPolygon(i);
            sum += e.radiance * emitterFormFactor(p, n, e);
        }
        return sum;
    }
    for (uint i = 0u; i < edgeCount; ++i) {
        EmitterEdge e = emitterEdge(i);
        bool faces = dot(e.normal, p) > e.height, beyondFaces = dot(e.normalBeyond, p) > e.heightBeyond;
        vec3 weight = vec3(0.0f, 0.0f, 0.0f);
        if (faces) weight = emitterPolygon(e.polygon).radiance;
        if (beyondFaces) weight -= emitterPolygon(e.polygonBeyond).radiance;
        if (weight != vec3(0.0f, 0.0f, 0.0f)) sum += weight * lambertEdge(n, e.from - p, e.along, 1.0f, 1.0f);
    }
    return max(0.5f * kInvPi * sum, vec3(0.0f, 0.0f, 0.0f));
}
