// The format is described in: G. Ward, "Real Pixels", Graphics Gems II, 1991, and Radiance's manual "File
// Formats", 1997. stb_image does not read it here, since its decoder never ends on a file that ends inside a
// run.
#include "assets/images/radiance_hdr.h"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace relume {
namespace {

using Rgbe = std::array<uint8_t, 4>;

// Rows of other widths are never stored channel by channel.
constexpr uint32_t kNarrowestPlanar = 8, kWidestPlanar = 0x7fff;

// Runs of rows stored channel by channel make 16 pixels of a byte, older ones of one colour more, up to whole
// rows.
constexpr uint64_t kMostHdrPacking = 1024, kFreePixels = 1 << 24;

std::string_view takeLine(std::string_view bytes, size_t& at) {
    const size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) throw std::runtime_error("its header does not end");
    std::string_view line = bytes.substr(at, end - at);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at = end + 1;
    return line;
}

/// Takes `axis` ("-Y ") and the number behind it off the line's front and returns the number.
uint32_t takeExtent(std::string_view& line, std::string_view axis) {
    uint32_t extent = 0;
    if (line.starts_with(axis)) {
        line.remove_prefix(axis.size());
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), extent);
        if (error == std::errc()) {
            line.remove_prefix(static_cast<size_t>(end - line.data()));
            if (line.starts_with(' ')) line.remove_prefix(1);
            if (extent > 0) return extent;
        }
    }
    throw std::runtime_error("its size is not told as '-Y height +X width'");
}

class PixelReader {
public:
    PixelReader(std::string_view bytes, size_t at) : bytes_(bytes), at_(at) {}

    void row(std::vector<Rgbe>& row, size_t width) {
        row.clear();
        if (width >= kNarrowestPlanar && width <= kWidestPlanar && isPlanar(width)) {
            row.resize(width);
            planarRow(row);
        } else {
            pixelRow(row, width);
        }
    }

private:
    uint8_t next() {
        if (at_ >= bytes_.size()) throw std::runtime_error("the file ends too early");
        return static_cast<uint8_t>(bytes_[at_++]);
    }

    bool isPlanar(size_t width) const {
        if (bytes_.size() < at_ + 4) return false;
        const auto byte = [&](size_t i) { return static_cast<uint8_t>(bytes_[at_ + i]); };
        return byte(0) == 2 && byte(1) == 2 && (size_t{byte(2)} << 8 | byte(3)) == width;
    }

    void planarRow(std::vector<Rgbe>& row) {
        at_ += 4;
        for (size_t channel = 0; channel < 4; ++channel)
            for (size_t x = 0; x < row.size();) {
                const uint8_t code = next();
                const bool isRun = code > 128;
                const size_t count = isRun ? code - 128u : code;
                if (count == 0 || count > row.size() - x) throw std::runtime_error("a run is damaged");
                const uint8_t value = isRun ? next() : 0;
                for (size_t i = 0; i < count; ++i)
                    row[x++][channel] = isRun ? value : next();
            }
    }

    // Reads a row stored pixel by pixel; (1, 1, 1, n) repeats the pixel before n times, further ones are
    // higher digits of n.
    void pixelRow(std::vector<Rgbe>& row, size_t width) {
        int shift = 0;
        while (row.size() < width) {
            Rgbe pixel;
            for (uint8_t& byte : pixel)
                byte = next();
            if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
                row.push_back(pixel);
                shift = 0;
                continue;
            }
            const size_t count = shift < 24 ? size_t{pixel[3]} << shift : width + 1;
            if (row.empty() || count > width - row.size()) throw std::runtime_error("a run is damaged");
            row.resize(row.size() + count, Rgbe(row.back()));
            shift += 8;
        }
    }

    std::string_view bytes_;
    size_t at_;
};

} // namespace

RadianceHeader readRadianceHeader(std::string_view bytes) {
    RadianceHeader header;
    const std::string_view magic = takeLine(bytes, header.dataBegin);
    if (magic != "#?RADIANCE" && magic != "#?RGBE") throw std::runtime_error("it is no Radiance picture");
    bool isRgb = true;
    for (std::string_view line = " "; !line.empty();) {
        line = takeLine(bytes, header.dataBegin);
        if (line.starts_with("FORMAT=")) isRgb = line == "FORMAT=32-bit_rle_rgbe";
    }
    if (!isRgb) throw std::runtime_error("its format is not 32-bit_rle_rgbe");
    std::string_view size = takeLine(bytes, header.dataBegin);
    header.height = takeExtent(size, "-Y ");
    header.width = takeExtent(size, "+X ");
    const uint64_t pixels = uint64_t{header.width} * header.height;
    if (pixels > kFreePixels && pixels / kMostHdrPacking > bytes.size())
        throw std::runtime_error("its header claims " + std::to_string(header.width) + " x " +
                                 std::to_string(header.height) + " pixels");
    return header;
}

FloatImage decodeRadiance(std::string_view bytes, const RadianceHeader& header) {
    FloatImage image{header.width, header.height, {"R", "G", "B"}, {}, {}};
    image.planes.resize(3);
    for (std::vector<float>& plane : image.planes)
        plane.reserve(size_t{header.width} *
                      header.height); // filled as rows come: a header may claim anything
    PixelReader reader(bytes, header.dataBegin);
    std::vector<Rgbe> row;
    for (size_t y = 0; y < header.height; ++y) {
        reader.row(row, header.width);
        for (size_t x = 0; x < header.width; ++x) {
            // The exponent is that of a mantissa below 1 with an excess of 128, the mantissa is in 1/256.
            const float unit = row[x][3] == 0 ? 0.0f : std::ldexp(1.0f, int{row[x][3]} - (128 + 8));
            for (size_t c = 0; c < 3; ++c)
                image.planes[c].push_back(unit * static_cast<float>(row[x][c]));
        }
    }
    return image;
}

} // namespace relume
