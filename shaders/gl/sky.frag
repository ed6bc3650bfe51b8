// Draws the sky, where nothing else is: one radiance or an equirectangular picture (PICTURE), exposed and
// tone mapped as the scene is.

#include "gl/light.glsl"
#include "lib/light/sky_place.glsl"

layout(binding = 0) uniform sampler2D picture;
layout(location = 0) uniform vec3 ahead;  // direction of the picture's middle, unit
layout(location = 1) uniform vec3 across; // from there to its right edge, at a distance of 1; 0: orthographic
layout(location = 2) uniform vec3 above;  // to its upper edge
layout(location = 3) uniform vec2 size;   // [pixels]
layout(location = 4) uniform vec3 radiance; // [cd/m^2]; of a picture: factor on it
layout(location = 5) uniform float rotation; // [rad]

out vec4 result; // as displayed; a: none for the meter, which is to expose what is lit

void main() {
    vec2 place = 2.0 * gl_FragCoord.xy / size - 1.0;
    vec3 direction = normalize(ahead + place.x * across + place.y * above);
    vec3 light = radiance;
    if (PICTURE != 0) light *= textureLod(picture, skyPlace(direction, rotation), 0.0).rgb;
    result = vec4(displayedLight(light).rgb, 0.0);
}
