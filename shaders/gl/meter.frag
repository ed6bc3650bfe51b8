// Measures the light of one cell of the picture: sum of log2(luminance), sum of luminance and number of pixels with light.

#include "lib/tone.glsl"
#include "gl/picture.glsl"

out vec4 result;

const float kDark = 1e-6; // of preScale's unit: no light at all

void main() {
    ivec2 size = pictureSize();
    vec2 cells = vec2(kMeterCells);
    ivec2 cell = ivec2(gl_FragCoord.xy);
    ivec2 first = ivec2(vec2(cell) / cells * vec2(size)), end = ivec2(vec2(cell + 1) / cells * vec2(size));
    vec3 sums = vec3(0.0);
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            vec4 pixel = fetchSample(ivec2(x, y), 0);
            float light = luminance(pixel.rgb);
            if (pixel.a > 0.0 && light > kDark) sums += vec3(log2(light), light, 1.0);
        }
    }
    result = vec4(sums, 0.0);
}
