// Draws a ball where the ray through this fragment meets it, lit by the light of its middle. LIGHTING 1 leaves its
// colour out, as the view of lighting does for surfaces.

#include "gl/light.glsl"

struct Ball {
    vec4 place;
    vec4 lighting[9]; // [cd/m^2]: what 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2 of a normal are multiplied with
};
layout(std430, binding = 1) readonly buffer Balls { Ball balls[]; };

layout(location = 0) uniform mat4 viewProjection;
layout(location = 3) uniform vec4 eye; // point; w 0: the direction towards it

in vec3 fragPoint;
flat in int fragBall;

out vec4 result; // as displayed; a: for the meter

const float kKindWaiting = 0.0, kKindLit = 1.0;
const vec3 kInside = vec3(0.95, 0.2, 0.55), kWaiting = vec3(0.5); // as displayed
const float kAlbedo = 0.8;                                        // of white plaster

void main() {
    vec3 centre = balls[fragBall].place.xyz;
    float radius = balls[fragBall].place.w;
    // Where the eye is far away, the ray begins near the ball: float has no digits to spare.
    vec3 direction = eye.w == 0.0 ? -normalize(eye.xyz) : normalize(fragPoint - eye.xyz);
    vec3 from = fragPoint - centre;
    float along = dot(from, direction);
    float inside = radius * radius - dot(from, from) + along * along;
    if (inside < 0.0) discard;
    vec3 point = from + (-along - sqrt(inside)) * direction;
    vec3 n = point / radius;
    vec4 clip = viewProjection * vec4(centre + point, 1.0);
    gl_FragDepth = clip.z / clip.w;
    float kind = balls[fragBall].lighting[0].w;
    if (kind != kKindLit) {
        float facing = 0.55 + 0.45 * abs(dot(n, direction));
        result = vec4((kind == kKindWaiting ? kWaiting : kInside) * facing, 0.0);
        return;
    }
    float values[9] = float[9](1.0, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0 * n.z * n.z - 1.0, n.x * n.z,
                               n.x * n.x - n.y * n.y);
    vec3 lighting = vec3(0.0);
    for (int i = 0; i < 9; ++i)
        lighting += values[i] * balls[fragBall].lighting[i].rgb;
    lighting = max(lighting, 0.0); // nine coefficients ring beside strong lights
    result = displayedLight(LIGHTING != 0 ? lighting : kAlbedo * lighting);
}
