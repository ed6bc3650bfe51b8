// Counts light and local errors of texels by their size, in bins of equal ratios. The file is compiled as C++, too
// (bake/base/local_error.h), which makes percentiles of the counts.
const uint kLightBins = 1280u, kErrorBins = 448u;
// A GPU counts a chunk in one of so many copies of both, which are added up later: all texels of a bright wall have one
// bin, and would wait for each other.
const uint kBinCopies = 64u, kBinsOfCopy = kLightBins + kErrorBins;
const float kLightBinsPerOctave = 16.0, kErrorBinsPerOctave = 16.0;
const float kLeastLightOctave = -40.0, kLeastErrorOctave = -24.0; // below is the first bin

// Returns how much it is worth to take variance from a texel of which the standard error is `off`, where 95 % of all texels
// are to come within `aim`: the derivative of the texels beyond it by their variance, in any one unit. What is far within
// is worth nothing, and what is far beyond little, as it stays there.
FUNCTION float localWorth(float off, float aim) {
    if (!(off > 0.1f * aim)) return 0.0f; // 1e-19 of what it is at most
    float x = aim / off;
    return x * x * x * exp(-0.5f * x * x);
}

FUNCTION uint binOf(float value, float leastOctave, float binsPerOctave, uint bins) {
    if (!(value > 0.0)) return 0u;
    float place = (log2(value) - leastOctave) * binsPerOctave;
    return uint(clamp(place, float(0u), float(bins - 1u)));
}

// Texels of one tile that touch are no further apart in a chunk's order than a row of the tile and one.
const uint kTileReach = 9u;

// Says whether these texels of a lightmap of `size` texels along an edge are one, or touch; kNoTexel touches none.
FUNCTION bool texelsTouch(uint a, uint b, uint size) {
    if (a == kNoTexel || b == kNoTexel) return false;
    int rows = int(a / size) - int(b / size), columns = int(a % size) - int(b % size);
    return rows * rows <= 1 && columns * columns <= 1;
}
