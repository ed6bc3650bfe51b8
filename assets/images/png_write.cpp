#include "assets/images/png_write.h"

#include "assets/base/error.h"
#include "assets/base/worker_pool.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <zlib.h>

namespace relume {
namespace {

// Rows are deflated in bands of about so many bytes, each by itself: a band's share of the file does not
// depend on who made it. A band begins with the end of the one before as its dictionary, so that the file is
// no larger than one that was deflated in one piece.
constexpr size_t kBandBytes = size_t{1} << 18;
constexpr size_t kDictionaryBytes = size_t{1} << 15; // all that DEFLATE looks back
// On shots of levels, the level above saves three hundredths and takes a third longer; the next one saves as
// much again and takes twice as long.
constexpr int kPngLevel = 4;
constexpr size_t kChunkBytes = size_t{1} << 30; // of an IDAT chunk; PNG allows 2^31 - 1
constexpr uint32_t kFilters = 5;                // none, left, up, mean of both, Paeth

uint8_t paeth(int left, int up, int corner) {
    const int a = std::abs(up - corner), b = std::abs(left - corner), c = std::abs(left + up - 2 * corner);
    return uint8_t(a <= b && a <= c ? left : b <= c ? up : corner);
}

// Filters one row; `above` is the row above or a row of zeros.
void filterRow(uint32_t filter, const uint8_t* row, const uint8_t* above, size_t bytes, size_t pixel,
               uint8_t* to) {
    for (size_t i = 0; i < bytes; ++i) {
        const uint8_t left = i < pixel ? uint8_t{0} : row[i - pixel], up = above[i];
        const uint8_t corner = i < pixel ? uint8_t{0} : above[i - pixel];
        const uint8_t foretold = filter == 0   ? uint8_t{0}
                                 : filter == 1 ? left
                                 : filter == 2 ? up
                                 : filter == 3 ? uint8_t((left + up) / 2)
                                               : paeth(left, up, corner);
        to[i] = uint8_t(row[i] - foretold);
    }
}

// Takes the filter whose differences are smallest, as the specification recommends.
void filterBest(const uint8_t* row, const uint8_t* above, size_t bytes, size_t pixel, uint8_t* to) {
    std::vector<uint8_t> tried(bytes);
    uint64_t least = UINT64_MAX;
    for (uint32_t filter = 0; filter < kFilters; ++filter) {
        filterRow(filter, row, above, bytes, pixel, tried.data());
        uint64_t sum = 0;
        for (const uint8_t difference : tried)
            sum += uint64_t(std::abs(int(int8_t(difference))));
        if (sum >= least) continue;
        least = sum;
        to[0] = uint8_t(filter);
        std::copy(tried.begin(), tried.end(), to + 1);
    }
}

// Deflates one band, byte-aligned at its end; the last one ends the stream. Returns "" on failure.
std::string deflateBand(std::string_view dictionary, std::string_view band, bool last) {
    z_stream stream{};
    if (deflateInit2(&stream, kPngLevel, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK)
        return "";
    const auto bytes = [](std::string_view text) {
        return reinterpret_cast<Bytef*>(const_cast<char*>(text.data())); // zlib does not write there
    };
    if (!dictionary.empty()) deflateSetDictionary(&stream, bytes(dictionary), uInt(dictionary.size()));
    constexpr size_t kMarker = 16; // of the flush at its end
    std::string packed(deflateBound(&stream, uLong(band.size())) + kMarker, '\0');
    stream.next_in = bytes(band);
    stream.avail_in = uInt(band.size());
    stream.next_out = bytes(packed);
    stream.avail_out = uInt(packed.size());
    const int result = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
    const bool done = result == (last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0;
    packed.resize(done ? stream.total_out : 0);
    deflateEnd(&stream);
    return packed;
}

void appendNumber(std::string& file, uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8)
        file += char(uint8_t(number >> shift));
}

void appendChunk(std::string& file, const char* type, std::string_view content) {
    appendNumber(file, uint32_t(content.size()));
    const size_t begin = file.size();
    file += type;
    file += content;
    const auto* bytes = reinterpret_cast<const Bytef*>(file.data() + begin);
    appendNumber(file, uint32_t(crc32_z(0, bytes, file.size() - begin)));
}

std::string pngHeaderOf(uint32_t width, uint32_t height, uint32_t channels) {
    constexpr char kBits = 8, kGrey = 0, kRgb = 2, kRgba = 6;
    std::string header;
    appendNumber(header, width);
    appendNumber(header, height);
    header += kBits;
    header += channels == 1 ? kGrey : channels == 3 ? kRgb : kRgba;
    header.append(3, '\0'); // DEFLATE, the five filters, not interlaced
    return header;
}

} // namespace

std::string writePng(const std::string& pixels, uint32_t width, uint32_t height, uint32_t channels,
                     const std::string& name) {
    ASSERT(width > 0 && height > 0 && (channels == 1 || channels == 3 || channels == 4));
    const size_t bytes = size_t{width} * channels, line = bytes + 1;
    ASSERT(pixels.size() == bytes * height);
    const uint32_t bandRows = uint32_t(std::clamp<size_t>(kBandBytes / line, 1, height));
    const uint32_t bands = (height + bandRows - 1) / bandRows;
    WorkerPool pool(std::min(bands, WorkerPool::defaultSize()));

    std::string lines(line * height, '\0');
    const auto* from = reinterpret_cast<const uint8_t*>(pixels.data());
    auto* to = reinterpret_cast<uint8_t*>(lines.data());
    const std::vector<uint8_t> zeros(bytes, 0);
    pool.run(bands, [&](uint32_t band) {
        for (uint32_t y = band * bandRows; y < std::min(height, (band + 1) * bandRows); ++y)
            filterBest(from + y * bytes, y > 0 ? from + (y - 1) * bytes : zeros.data(), bytes, channels,
                       to + y * line);
    });

    struct Packed {
        std::string bytes;
        uLong sum = 0; // Adler-32
        size_t size = 0;
    };
    std::vector<Packed> packed(bands);
    pool.run(bands, [&](uint32_t band) {
        const size_t begin = size_t{band} * bandRows * line;
        const std::string_view all(lines), own = all.substr(begin, bandRows * line);
        const size_t before = std::min(begin, kDictionaryBytes);
        packed[band] = {deflateBand(all.substr(begin - before, before), own, band + 1 == bands),
                        adler32_z(1, reinterpret_cast<const Bytef*>(own.data()), own.size()), own.size()};
    });
    constexpr char kStreamHead[] = "\x78\x5e"; // a window of 32 KiB, a quick level [RFC 1950]
    std::string stream = kStreamHead;
    uLong sum = 1;
    for (const Packed& part : packed) {
        if (part.bytes.empty()) throw Error(name + ": cannot be encoded as PNG: write .exr instead");
        stream += part.bytes;
        sum = adler32_combine(sum, part.sum, z_off_t(part.size));
    }
    appendNumber(stream, uint32_t(sum));

    std::string file = "\x89PNG\r\n\x1a\n";
    appendChunk(file, "IHDR", pngHeaderOf(width, height, channels));
    for (size_t at = 0; at < stream.size(); at += kChunkBytes)
        appendChunk(file, "IDAT", std::string_view(stream).substr(at, kChunkBytes));
    appendChunk(file, "IEND", "");
    return file;
}

} // namespace relume
