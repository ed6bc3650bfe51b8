// Measures the light of one cell of the picture: sum of log2(luminance), sum of luminance and number of
// pixels with light.

#include "lib/tone.glsl"
#include "gl/picture.glsl"

out vec4 result;

// A step in each row and column [pixels]: a ninth of the work, and of large pictures still twenty in each
// cell.
const int kStep = 3;

void main() {
    ivec2 size = pictureSize();
    vec2 cells = vec2(kMeterCells);
    ivec2 cell = ivec2(gl_FragCoord.xy);
    ivec2 first = ivec2(vec2(cell) / cells * vec2(size)), end = ivec2(vec2(cell + 1) / cells * vec2(size));
    vec3 sums = vec3(0.0);
    for (int y = first.y; y < end.y; y += kStep) {
        for (int x = first.x; x < end.x; x += kStep) {
            float code = 255.0 * fetchSample(ivec2(x, y), 0).a;
            if (code < 0.5) continue;
            float bright = meterLog2(code);
            sums += vec3(bright, exp2(bright), 1.0);
        }
    }
    result = vec4(sums, 0.0);
}
