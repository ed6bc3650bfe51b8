#pragma once

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include "tests/exr_claims.h"
#include "tests/fuzz/fuzz.h"

namespace relume::fuzz {

inline std::string contentOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns a ramp in half or float, by one of OpenEXR's codecs, in lines or tiles.
inline std::string exrRamp(Imf::Compression compression, Imf::PixelType type, bool tiled) {
    constexpr int kWidth = 13, kHeight = 40;
    std::vector<float> floats(size_t{kWidth} * kHeight);
    std::vector<half> halves(floats.size());
    for (size_t i = 0; i < floats.size(); ++i)
        halves[i] = half(floats[i] = 0.01f * static_cast<float>(i % 97));
    Imf::Header header(kWidth, kHeight);
    header.compression() = compression;
    Imf::FrameBuffer frame;
    for (const char* channel : {"R", "G", "B", "coverage"}) {
        header.channels().insert(channel, Imf::Channel(type));
        frame.insert(channel, type == Imf::HALF ? Imf::Slice::Make(type, halves.data(), header.dataWindow())
                                                : Imf::Slice::Make(type, floats.data(), header.dataWindow()));
    }
    const std::string path = besideInputs("ramp.exr");
    if (tiled) {
        header.setTileDescription(Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS));
        Imf::TiledOutputFile file(path.c_str(), header);
        for (int level = 0; level < file.numLevels(); ++level) {
            file.setFrameBuffer(frame);
            file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
        }
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(kHeight);
    }
    return contentOf(path);
}

/// Returns small headers that once took gigabytes.
inline std::vector<std::string> claimingExrs() {
    using test::ExrClaims;
    ExrClaims tiles{.right = 32767, .bottom = 32767};
    tiles.tileWidth = tiles.tileHeight = 1;
    ExrClaims attribute;
    attribute.more = test::text("other") + test::text("string") + test::raw(0x7fffffff);
    return {ExrClaims{.right = 3, .bottom = 0x3fffffff}.bytes(),
            ExrClaims{.right = 4095, .bottom = 4095, .channels = 100}.bytes("xxxxxxxx"),
            ExrClaims{.right = 999'999, .bottom = 0, .channels = 9, .compression = 9}.bytes("xxxxxxxx"),
            tiles.bytes(),
            attribute.bytes(),
            ExrClaims{.version = 2 | 0x800}.bytes(),
            test::raw(20000630) + test::raw(2 | 0x1000) + ExrClaims{.type = "deepscanline"}.header() + '\0'};
}

} // namespace relume::fuzz
