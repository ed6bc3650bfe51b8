// Tells where in a sky's equirectangular picture a direction lies, and back: assets/model/scene.h, Sky.

CONST float kTurn = 6.28318531f;

// Returns the place, in [0, 1)^2.
FUNCTION vec2 skyPlace(vec3 d, float rotation) {
    float u = 0.5f + (atan(d.x, -d.z) + rotation) / kTurn;
    return vec2(u - floor(u), acos(clamp(d.y, -1.0f, 1.0f)) * 2.0f / kTurn);
}

FUNCTION vec3 skyDirection(vec2 place, float rotation) {
    float polar = 0.5f * kTurn * place.y, angle = kTurn * (place.x - 0.5f) - rotation;
    return vec3(sin(polar) * sin(angle), cos(polar), -sin(polar) * cos(angle));
}
