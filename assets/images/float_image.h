#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace relume {

/// Holds planes of 32-bit floats; row 0 is on top, at v = 0.
struct FloatImage {
    uint32_t width = 0, height = 0;
    std::vector<std::string> channels;             // e.g. "R", "G", "B", "coverage"
    std::vector<std::vector<float>> planes;        // one per channel, [width * height]
    std::map<std::string, std::string> attributes; // strings written into the EXR header

    /// Returns the plane of a channel, or nullptr where there is none.
    const std::vector<float>* find(const std::string& channel) const;
    std::vector<float>& add(const std::string& channel); // a new plane of zeros
};

enum class ExrType { Float, Half };

/// How an OpenEXR file is compressed: those of its ways that keep every bit. Which is quicker and which
/// smaller is in tests/bench/measured.md.
enum class ExrCompression {
    Off,  // X11 takes the word None
    Rle,  // runs of equal bytes
    Zips, // DEFLATE, row by row
    Zip,  // DEFLATE, 16 rows at a time
    Piz,  // wavelets, 32 rows at a time
};
constexpr ExrCompression kExrCompression = ExrCompression::Zip; // where nobody says which

/// Applies the exact transfer function of sRGB [IEC 61966-2-1]; values outside [0, 1] follow the same curve,
/// mirrored below 0.
double srgbFromLinear(double linear);
double linearFromSrgb(double encoded);
/// Returns floor(255 srgbFromLinear(x) + 0.5) of x = linear clamped to [0, 1], what a picture of 8 bits has;
/// 0 for NaN.
uint8_t srgbByte(float linear);

/// These are 32768^2 pixels; a header that claims more is that of a broken file.
constexpr uint64_t kMostImagePixels = uint64_t(1) << 30;

} // namespace relume
