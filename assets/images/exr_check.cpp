// The layout is told by "OpenEXR File Layout" and "Technical Introduction to OpenEXR", openexr.com.
#include "assets/images/exr_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

namespace relume::exr {
namespace {

constexpr uint32_t kMagic = 20000630;
constexpr uint32_t kTiledFlag = 0x200, kDeepFlag = 0x800, kPartsFlag = 0x1000;
constexpr size_t kLongestName = 255; // [bytes]

// No picture is longer than this; tables with entries for each line stay below 32 MiB.
constexpr int64_t kMostEdge = 1 << 20;   // [pixels]
constexpr int64_t kMostPixels = 1 << 30; // as in kMostImagePixels; keeps the products below within 64 bits
// Lines of 32768 pixels with four float channels make 134 MB of DWAB's 256 lines.
constexpr uint64_t kMostChunkBytes = uint64_t(1) << 28;
// Below this, only the codec's best case limits what a byte may unfold to; above, DEFLATE's best case does.
// The others reach more with pictures of one colour only.
constexpr uint64_t kFreeBytes = uint64_t(1) << 30, kMostPacking = 1100;
constexpr uint64_t kSlack = 64; // [bytes]; the best cases below are those of long runs

struct Codec {
    uint32_t lines;   // of a chunk
    uint64_t packing; // bytes that a byte unfolds to at best
};
// The codecs are in the order of their numbers: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
// DEFLATE makes 1032 of 1; PXR24 drops a byte of four before, PIZ writes a run of 256 values of two bytes in
// ten bits, and DWA leaves out all but one of 64 values before.
constexpr std::array<Codec, 10> kCodecs = {{{1, 1},
                                            {1, 64},
                                            {1, 1040},
                                            {16, 1040},
                                            {32, 512},
                                            {16, 1400},
                                            {32, 16},
                                            {32, 16},
                                            {32, 70000},
                                            {256, 70000}}};

/// OpenEXR reads values of these types by their own size and goes on from there, whatever size is told.
constexpr std::array<std::pair<std::string_view, size_t>, 24> kTypes = {{{"box2f", 16},
                                                                         {"box2i", 16},
                                                                         {"chromaticities", 32},
                                                                         {"compression", 1},
                                                                         {"deepImageState", 1},
                                                                         {"double", 8},
                                                                         {"envmap", 1},
                                                                         {"float", 4},
                                                                         {"int", 4},
                                                                         {"keycode", 28},
                                                                         {"lineOrder", 1},
                                                                         {"m33d", 72},
                                                                         {"m33f", 36},
                                                                         {"m44d", 128},
                                                                         {"m44f", 64},
                                                                         {"rational", 8},
                                                                         {"tiledesc", 9},
                                                                         {"timecode", 8},
                                                                         {"v2d", 16},
                                                                         {"v2f", 8},
                                                                         {"v2i", 8},
                                                                         {"v3d", 24},
                                                                         {"v3f", 12},
                                                                         {"v3i", 12}}};

/// Holds what a part's header claims.
struct Part {
    int64_t width = 0, height = 0;
    uint64_t pixelBytes = 0; // of all channels
    uint8_t compression = 0;
    bool tiled = false, hasWindow = false, hasChannels = false;
    uint32_t tileWidth = 0, tileHeight = 0;
    uint64_t chunks = 0; // as told, 0 where it is not
};

class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}
    size_t left() const { return bytes_.size() - at_; }
    bool atNull() const { return left() > 0 && bytes_[at_] == '\0'; }
    std::string_view take(size_t size) {
        if (size > left()) throw std::runtime_error("the file ends too early");
        at_ += size;
        return bytes_.substr(at_ - size, size);
    }
    template<typename T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
        return value;
    }
    std::string_view text() {
        const std::string_view rest = bytes_.substr(at_, kLongestName + 1);
        const size_t length = rest.find('\0');
        if (length == std::string_view::npos) throw std::runtime_error("a name in its header does not end");
        return take(length + 1).substr(0, length);
    }

private:
    std::string_view bytes_;
    size_t at_ = 0;
};

[[noreturn]] void failClaim(const std::string& claim) {
    throw std::runtime_error("its header claims " + claim);
}

void readWindow(Reader value, Part& part) {
    const int64_t left = value.number<int32_t>(), top = value.number<int32_t>();
    const int64_t right = value.number<int32_t>(), bottom = value.number<int32_t>();
    part.width = right - left + 1;
    part.height = bottom - top + 1;
    part.hasWindow = true;
    if (part.width < 1 || part.height < 1 || part.width > kMostEdge || part.height > kMostEdge ||
        part.width * part.height > kMostPixels)
        failClaim(fmt::format("{} x {} pixels", part.width, part.height));
}

void readChannels(Reader value, Part& part) {
    part.pixelBytes = 0;
    part.hasChannels = true;
    while (!value.atNull()) {
        const std::string_view name = value.text();
        const int32_t type = value.number<int32_t>();
        value.take(4); // whether its values are linear, and three bytes that mean nothing
        const int32_t across = value.number<int32_t>(), down = value.number<int32_t>();
        if (across != 1 || down != 1)
            throw std::runtime_error(
                fmt::format("channel {} is subsampled, which is not supported", std::string(name)));
        part.pixelBytes += type == 1 ? 2 : 4; // half; unsigned and float
    }
    if (value.left() != 1) failClaim("channels that do not fill their list");
}

void readTiles(Reader value, Part& part) {
    part.tileWidth = value.number<uint32_t>();
    part.tileHeight = value.number<uint32_t>();
    if (part.tileWidth < 1 || part.tileHeight < 1 || part.tileWidth > kMostEdge ||
        part.tileHeight > kMostEdge)
        failClaim(fmt::format("tiles of {} x {} pixels", part.tileWidth, part.tileHeight));
}

void readType(std::string_view type, Part& part) {
    if (type.starts_with("deep")) throw std::runtime_error("it holds deep data, which is not supported");
    if (type.starts_with("tiled")) part.tiled = true;
}

/// Checks the sizes that OpenEXR knows from an attribute's type, or takes from inside it.
void checkValue(std::string_view type, Reader value) {
    const auto known =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == type; });
    if ((known != kTypes.end() && known->second != value.left()) ||
        (type == "floatvector" && value.left() % 4 != 0))
        failClaim(fmt::format("{} bytes for a value of type {}", value.left(), std::string(type)));
    if (type == "preview") {
        const uint64_t width = value.number<uint32_t>(), height = value.number<uint32_t>();
        if (width * height != value.left() / 4 || value.left() % 4 != 0)
            failClaim(fmt::format("a preview of {} x {} pixels", width, height));
    } else if (type == "stringvector") {
        while (value.left() > 0) {
            const int32_t length = value.number<int32_t>();
            if (length < 0) failClaim("a text of negative length");
            value.take(static_cast<size_t>(length));
        }
    }
}

void readAttribute(Reader& reader, Part& part) {
    const std::string_view name = reader.text(), type = reader.text();
    const int32_t size = reader.number<int32_t>();
    if (size < 0 || static_cast<size_t>(size) > reader.left())
        failClaim(fmt::format("{} bytes of attribute {}", size, std::string(name)));
    const std::string_view bytes = reader.take(static_cast<size_t>(size));
    Reader value(bytes);
    checkValue(type, value);
    if (name == "dataWindow" && type == "box2i") {
        readWindow(value, part);
    } else if (name == "channels" && type == "chlist") {
        readChannels(value, part);
    } else if (name == "compression" && type == "compression") {
        part.compression = value.number<uint8_t>();
        if (part.compression >= kCodecs.size()) failClaim("a compression that is not known");
    } else if (name == "tiles" && type == "tiledesc") {
        readTiles(value, part);
    } else if (name == "type" && type == "string") {
        readType(bytes, part);
    } else if (name == "chunkCount" && type == "int") {
        const int32_t chunks = value.number<int32_t>();
        if (chunks < 0) failClaim("a negative number of chunks");
        part.chunks = static_cast<uint64_t>(chunks);
    }
}

Part readHeader(Reader& reader, bool tiled) {
    Part part;
    part.tiled = tiled;
    while (!reader.atNull())
        readAttribute(reader, part);
    reader.take(1);
    if (!part.hasWindow || !part.hasChannels)
        throw std::runtime_error("its header has no size or no channels");
    if (part.tiled && part.tileWidth == 0)
        throw std::runtime_error("its header does not tell the size of tiles");
    return part;
}

uint64_t ceilDivide(uint64_t a, uint64_t b) {
    return (a + b - 1) / b;
}

/// Returns how many entries the part's table of chunks has at least.
uint64_t chunksOf(const Part& part) {
    const auto width = static_cast<uint64_t>(part.width), height = static_cast<uint64_t>(part.height);
    if (!part.tiled) return std::max(part.chunks, ceilDivide(height, kCodecs[part.compression].lines));
    return std::max(part.chunks, ceilDivide(width, part.tileWidth) * ceilDivide(height, part.tileHeight));
}

/// Returns what a part unfolds to [bytes].
uint64_t unfolded(const Part& part) {
    return static_cast<uint64_t>(part.width) * static_cast<uint64_t>(part.height) * part.pixelBytes;
}

void checkChunk(const Part& part) {
    const auto width = static_cast<uint64_t>(part.width);
    const uint64_t rows = part.tiled ? part.tileHeight : kCodecs[part.compression].lines;
    const uint64_t across =
        part.tiled ? std::max<uint64_t>(width, part.tileWidth) : width; // rows of tiles are kept
    if (across * rows > kMostPixels ||
        across * rows * part.pixelBytes > std::max(kMostChunkBytes, unfolded(part)))
        failClaim(fmt::format("pieces of {} x {} pixels of {} bytes", across, rows, part.pixelBytes));
}

} // namespace

void checkHeaders(std::string_view bytes) {
    Reader reader(bytes);
    if (reader.number<uint32_t>() != kMagic) throw std::runtime_error("it is no OpenEXR file");
    const uint32_t version = reader.number<uint32_t>();
    if (version & kDeepFlag) throw std::runtime_error("it holds deep data, which is not supported");
    const bool severalParts = version & kPartsFlag;
    uint64_t all = 0, packed = 0, chunks = 0;
    do {
        const Part part = readHeader(reader, version & kTiledFlag);
        checkChunk(part);
        const uint64_t size = unfolded(part);
        all += size;
        packed += size / kCodecs[part.compression].packing;
        chunks += chunksOf(part);
        const bool tooSmall = all > kFreeBytes && all / kMostPacking > bytes.size();
        if (tooSmall || packed > bytes.size() + kSlack)
            failClaim(fmt::format("{} x {} pixels of {} bytes", part.width, part.height, part.pixelBytes));
    } while (severalParts && !reader.atNull());
    if (severalParts) reader.take(1);
    if (chunks > reader.left() / sizeof(uint64_t))
        failClaim(fmt::format("{} chunks of pixels, more than the file has room for", chunks));
}

} // namespace relume::exr
