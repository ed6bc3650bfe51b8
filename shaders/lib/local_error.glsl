// Counts light and local errors of texels by their size, in bins of equal ratios. The file is compiled as C++, too
// (bake/base/local_error.h), which makes percentiles of the counts.
const uint kLightBins = 1280u, kErrorBins = 448u;
const float kLightBinsPerOctave = 16.0, kErrorBinsPerOctave = 16.0;
const float kLeastLightOctave = -40.0, kLeastErrorOctave = -24.0; // below is the first bin

FUNCTION uint binOf(float value, float leastOctave, float binsPerOctave, uint bins) {
    if (!(value > 0.0)) return 0u;
    float place = (log2(value) - leastOctave) * binsPerOctave;
    return uint(clamp(place, float(0u), float(bins - 1u)));
}
