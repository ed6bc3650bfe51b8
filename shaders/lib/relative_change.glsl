// How much a bounce changed the light of a patch, relative to its own. It is legal as GLSL and as C++ (namespace
// relume::shader).

// Returns |change| / |now|, of R, G and B together: 1 where all light is new, 0 where there is none.
FUNCTION float relativeChange(vec3 now, vec3 change) {
    float light = abs(now.x) + abs(now.y) + abs(now.z), by = abs(change.x) + abs(change.y) + abs(change.z);
    return light > 0.0f ? min(by / light, 1.0f) : 0.0f;
}
