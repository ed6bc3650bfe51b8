#include "assets/images/ktx2.h"

#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/exr_part.h"
#include "assets/images/shared_exponent.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace relume {
namespace {

// These values are those of the KTX 2.0 specification, sections 3 and 5.
constexpr std::array<unsigned char, 12> kIdentifier = {0xAB, 'K',  'T',  'X',  ' ',  '2',
                                                       '0',  0xBB, '\r', '\n', 0x1A, '\n'};
constexpr uint32_t kNoSupercompression = 0, kZstandard = 2;
constexpr size_t kHeaderBytes = 80, kLevelBytes = 24;

// These are the words of a header, behind the identifier.
enum HeaderWord : size_t {
    kWordFormat,
    kWordTypeSize,
    kWordWidth,
    kWordHeight,
    kWordDepth,
    kWordLayers,
    kWordFaces,
    kWordLevels,
    kWordScheme,
    kWordCount
};

size_t texelBytes(Ktx2Format format) {
    return format == Ktx2Format::Half ? 8 : 4;
}

void put32(std::string& out, uint64_t value) {
    for (int shift = 0; shift < 32; shift += 8)
        out += static_cast<char>(value >> shift & 0xff);
}
void put64(std::string& out, uint64_t value) {
    put32(out, value & 0xffffffffu);
    put32(out, value >> 32);
}

uint64_t read(const std::string& bytes, size_t at, size_t size) {
    if (at > bytes.size() || size > bytes.size() - at) throw std::runtime_error("it is cut off");
    uint64_t value = 0;
    for (size_t i = 0; i < size; ++i)
        value |= uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return value;
}

// One sample of a data format descriptor [Khronos Data Format Specification 1.3, section 5.12].
struct Sample {
    uint32_t bit = 0, bits = 0, channel = 0, qualifiers = 0, lower = 0, upper = 0;
};

std::vector<Sample> samplesOf(Ktx2Format format) {
    constexpr uint32_t kSigned = 4, kFloat = 8, kExponent = 2, kAlpha = 15;
    if (format == Ktx2Format::Half) {
        std::vector<Sample> out;
        const std::array<uint32_t, 4> channels = {0, 1, 2, kAlpha};
        for (uint32_t i = 0; i < 4; ++i)
            out.push_back({16 * i, 16, channels[i], kSigned | kFloat, 0xBF800000u, 0x3F800000u}); // -1, 1
        return out;
    }
    std::vector<Sample> out;
    for (uint32_t i = 0; i < 3; ++i) {
        // A mantissa of 8448 stands for 1 at an exponent of 11 - 15 + 9 = 5 bits; an exponent has bias 15.
        out.push_back({9 * i, 9, i, 0, 0, 8448});
        out.push_back({27, 5, i, kExponent, 15, 31});
    }
    return out;
}

std::string descriptorOf(Ktx2Format format) {
    constexpr uint32_t kVersion = 2, kRgbsda = 1, kBt709 = 1, kLinear = 1;
    const std::vector<Sample> samples = samplesOf(format);
    const size_t blockBytes = 24 + 16 * samples.size();
    std::string out;
    put32(out, 4 + blockBytes);
    put32(out, 0); // Khronos' basic descriptor
    put32(out, kVersion | blockBytes << 16);
    put32(out, kRgbsda | kBt709 << 8 | kLinear << 16);
    put32(out, 0); // blocks of one texel
    put64(out, texelBytes(format));
    for (const Sample& sample : samples) {
        put32(out, sample.bit | (sample.bits - 1) << 16 | sample.channel << 24 | sample.qualifiers << 28);
        put32(out, 0); // its place in the texel
        put32(out, sample.lower);
        put32(out, sample.upper);
    }
    return out;
}

void putPair(std::string& out, std::string pair) {
    pair += '\0';
    put32(out, pair.size());
    out += pair;
    out.resize((out.size() + 3) / 4 * 4, '\0');
}

std::string texelsOf(const FloatImage& image, Ktx2Format format, const std::string& name) {
    std::array<const std::vector<float>*, 3> planes{};
    for (size_t c = 0; c < 3; ++c) {
        const std::string channel(1, "RGB"[c]);
        planes[c] = image.find(channel);
        if (!planes[c]) throw Error(name + ": the image has no channel " + channel);
    }
    const size_t count = size_t{image.width} * image.height;
    std::string out;
    out.reserve(count * texelBytes(format));
    size_t cut = 0;
    if (format == Ktx2Format::Half) {
        std::array<std::vector<half>, 3> halves;
        WorkerPool pool(0);
        for (size_t c = 0; c < 3; ++c) {
            halves[c].resize(count);
            cut += exr::toHalf(pool, *planes[c], halves[c].data());
        }
        const half one(1.0f);
        for (size_t i = 0; i < count; ++i)
            for (size_t c = 0; c < 4; ++c) {
                const uint16_t bits = (c < 3 ? halves[c][i] : one).bits();
                out += static_cast<char>(bits & 0xff);
                out += static_cast<char>(bits >> 8);
            }
    } else {
        for (size_t i = 0; i < count; ++i) {
            const glm::vec3 color((*planes[0])[i], (*planes[1])[i], (*planes[2])[i]);
            const glm::vec3 bounded = glm::clamp(color, 0.0f, kMostSharedExponent);
            for (int c = 0; c < 3; ++c)
                cut += bounded[c] != color[c];
            put32(out, packSharedExponent(bounded));
        }
    }
    if (cut > 0)
        spdlog::warn("{}: {} values were cut to fit the texture's range: keep the .exr for them", name, cut);
    return out;
}

std::string packed(const std::string& texels) {
    constexpr int kLevel = 12; // the highest that takes no more than a second for 4096 x 4096 on two cores
    std::string out(ZSTD_compressBound(texels.size()), '\0');
    const size_t size = ZSTD_compress(out.data(), out.size(), texels.data(), texels.size(), kLevel);
    if (ZSTD_isError(size)) throw Error(std::string("Zstandard: ") + ZSTD_getErrorName(size));
    out.resize(size);
    return out;
}

std::string unpacked(const std::string& bytes, size_t at, size_t length, size_t wanted) {
    std::string out;
    // No claim of the header takes memory that the stream does not have: a frame tells its own size.
    if (ZSTD_getFrameContentSize(bytes.data() + at, length) != wanted)
        throw std::runtime_error("its Zstandard frame has another size than its header");
    out.resize(wanted);
    const size_t size = ZSTD_decompress(out.data(), out.size(), bytes.data() + at, length);
    if (ZSTD_isError(size) || size != wanted) throw std::runtime_error("its Zstandard data are damaged");
    return out;
}

} // namespace

std::string encodeKtx2(const FloatImage& image, const Ktx2Desc& desc, const std::string& name) {
    ASSERT(image.width > 0 && image.height > 0 && desc.depth > 0 && image.height % desc.depth == 0);
    const std::string texels = texelsOf(image, desc.format, name);
    const std::string level = desc.zstd ? packed(texels) : texels;
    const std::string descriptor = descriptorOf(desc.format);
    std::string pairs; // in the order of their keys
    putPair(pairs,
            desc.depth > 1 ? std::string("KTXorientation\0ruo", 18) : std::string("KTXorientation\0rd", 17));
    putPair(pairs, std::string("KTXwriter\0Relume", 16));

    const size_t descriptorAt = kHeaderBytes + kLevelBytes, pairsAt = descriptorAt + descriptor.size();
    size_t levelAt = pairsAt + pairs.size();
    if (!desc.zstd)
        levelAt = (levelAt + texelBytes(desc.format) - 1) / texelBytes(desc.format) * texelBytes(desc.format);
    std::string out(kIdentifier.begin(), kIdentifier.end());
    std::array<uint32_t, kWordCount> words{};
    words[kWordFormat] = static_cast<uint32_t>(desc.format);
    words[kWordTypeSize] = desc.format == Ktx2Format::Half ? 2 : 4;
    words[kWordWidth] = image.width;
    words[kWordHeight] = image.height / desc.depth;
    words[kWordDepth] = desc.depth > 1 ? desc.depth : 0;
    words[kWordFaces] = words[kWordLevels] = 1;
    words[kWordScheme] = desc.zstd ? kZstandard : kNoSupercompression;
    for (const uint32_t word : words)
        put32(out, word);
    put32(out, descriptorAt);
    put32(out, descriptor.size());
    put32(out, pairsAt);
    put32(out, pairs.size());
    put64(out, 0); // no supercompression global data
    put64(out, 0);
    put64(out, levelAt);
    put64(out, level.size());
    put64(out, texels.size());
    out += descriptor;
    out += pairs;
    out.resize(levelAt, '\0');
    return out + level;
}

FloatImage decodeKtx2(const std::string& bytes, const std::string& path, uint64_t mostPixels) {
    if (bytes.size() < kIdentifier.size() ||
        std::memcmp(bytes.data(), kIdentifier.data(), kIdentifier.size()) != 0)
        throw std::runtime_error("it is no KTX 2.0 file");
    std::array<uint32_t, kWordCount> words{};
    for (size_t i = 0; i < words.size(); ++i)
        words[i] = static_cast<uint32_t>(read(bytes, kIdentifier.size() + 4 * i, 4));
    const auto format = Ktx2Format{words[kWordFormat]};
    if (format != Ktx2Format::Half && format != Ktx2Format::SharedExponent)
        throw std::runtime_error(
            fmt::format("its vkFormat is {}; 97 (RGBA16F) and 123 (RGB9E5) are read", words[kWordFormat]));
    if (words[kWordDepth] > 1 || words[kWordLayers] > 1 || words[kWordFaces] != 1)
        throw std::runtime_error("it is not a single 2D picture");
    if (words[kWordScheme] != kNoSupercompression && words[kWordScheme] != kZstandard)
        throw std::runtime_error(fmt::format(
            "its supercompression scheme is {}; 0 (none) and 2 (Zstandard) are read", words[kWordScheme]));
    exr::checkPixels(path, words[kWordWidth], words[kWordHeight], mostPixels);
    const size_t count = size_t{words[kWordWidth]} * words[kWordHeight], wanted = count * texelBytes(format);
    const uint64_t at = read(bytes, kHeaderBytes, 8), length = read(bytes, kHeaderBytes + 8, 8);
    if (count == 0 || at > bytes.size() || length > bytes.size() - at)
        throw std::runtime_error("it is cut off");
    const bool zstd = words[kWordScheme] == kZstandard;
    if (!zstd && length != wanted) throw std::runtime_error("its level has another size than its header");
    const std::string texels = zstd ? unpacked(bytes, at, length, wanted) : bytes.substr(at, length);

    FloatImage image;
    image.width = words[kWordWidth];
    image.height = words[kWordHeight];
    for (const char* channel : {"R", "G", "B"})
        image.add(channel);
    for (size_t i = 0; i < count; ++i) {
        glm::vec3 color(0.0f);
        if (format == Ktx2Format::Half) {
            for (size_t c = 0; c < 3; ++c) {
                half value;
                value.setBits(static_cast<uint16_t>(read(texels, 8 * i + 2 * c, 2)));
                color[static_cast<int>(c)] = value;
            }
        } else {
            color = unpackSharedExponent(static_cast<uint32_t>(read(texels, 4 * i, 4)));
        }
        for (int c = 0; c < 3; ++c)
            image.planes[static_cast<size_t>(c)][i] = color[c];
    }
    return image;
}

} // namespace relume
