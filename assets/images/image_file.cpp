#include "assets/images/image_file.h"

#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/base/worker_pool.h"
#include "assets/images/exr_check.h"
#include "assets/images/exr_part.h"
#include "assets/images/ktx2.h"
#include "assets/images/png_check.h"
#include "assets/images/png_write.h"
#include "assets/images/radiance_hdr.h"

#include <ImfInputFile.h>
#include <ImfOutputFile.h>

// This is our own static copy; other libraries carry theirs under the same names.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb_image.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>

namespace relume {
namespace {

// This bounds the pixels per byte: DEFLATE makes 1032 bytes of one at best, each of eight pixels.
constexpr uint64_t kMostPngPacking = 8 * 1040;

enum class Format { Exr, Png, Hdr, Ktx2 };
enum class Access { Read, Write };

Format formatOf(const std::string& path, Access access) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (ending == ".exr") return Format::Exr;
    if (ending == ".png") return Format::Png;
    if (ending == ".hdr" && access == Access::Read) return Format::Hdr;
    if (ending == ".ktx2" && access == Access::Read) return Format::Ktx2;
    throw Error(path + ": unknown image ending '" + ending + "': use .exr or .png" +
                (access == Access::Read ? ", .hdr or .ktx2" : ""));
}

FloatImage readExr(const std::string& path, const std::string& bytes, uint64_t mostPixels) {
    exr::checkHeaders(bytes);
    exr::MemoryInput stream(path.c_str(), bytes);
    Imf::InputFile file(stream); // of several parts the first one
    return exr::readPart(file, path, mostPixels);
}

std::string encodeExr(const std::string& path, const FloatImage& image, ExrType type,
                      ExrCompression compression) {
    exr::MemoryOutput stream(path.c_str(), exr::mostBytes(image, type));
    exr::PartWriter writer(type);
    {
        Imf::OutputFile file(stream, exr::headerOf(image, type, compression));
        writer.write(file, image);
    } // its destructor writes the table of lines
    writer.warnAboutCut(path);
    return std::move(stream.bytes);
}

FloatImage readHdr(const std::string& path, const std::string& bytes, uint64_t mostPixels) {
    const RadianceHeader header = readRadianceHeader(bytes);
    exr::checkPixels(path, header.width, header.height, mostPixels);
    return decodeRadiance(bytes, header);
}

/// Gives a PNG the end that it may lack, since stb reads no picture without it.
std::string mendedPng(const std::string& path, std::string bytes) {
    PngDamage damage = findPngDamage(bytes);
    if (!damage.problem.empty())
        spdlog::warn("{}: {}: it is damaged, make or copy it again", path, damage.problem);
    return damage.mended.empty() ? std::move(bytes) : std::move(damage.mended);
}

FloatImage readPng(const std::string& path, std::string bytes, uint64_t mostPixels) {
    if (bytes.size() > size_t(std::numeric_limits<int>::max())) throw std::runtime_error("too large");
    bytes = mendedPng(path, std::move(bytes));
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = int(bytes.size());
    int width = 0, height = 0, channels = 0;
    if (stbi_info_from_memory(data, size, &width, &height, &channels)) {
        exr::checkPixels(path, uint64_t(width), uint64_t(height), mostPixels);
        if (uint64_t(width) * uint64_t(height) / kMostPngPacking > bytes.size())
            throw std::runtime_error(fmt::format("its header claims {} x {} pixels", width, height));
    }
    // All are read with 16 bits: stb widens 8-bit values v to 257 v, which is exact.
    const std::unique_ptr<stbi_us, void (*)(void*)> pixels(
        stbi_load_16_from_memory(data, size, &width, &height, &channels, 3), stbi_image_free);
    if (!pixels) throw std::runtime_error(stbi_failure_reason());
    FloatImage image;
    image.width = uint32_t(width);
    image.height = uint32_t(height);
    for (size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.add(std::string(1, "RGB"[c]));
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = float(linearFromSrgb(pixels.get()[3 * i + c] / 65535.0));
    }
    return image;
}

} // namespace

FloatImage readImage(const std::string& path, uint64_t mostPixels) {
    const Format format = formatOf(path, Access::Read);
    std::string bytes = exr::readBytes(path);
    try {
        if (format == Format::Hdr) return readHdr(path, bytes, mostPixels);
        if (format == Format::Ktx2) return decodeKtx2(bytes, path, mostPixels);
        return format == Format::Exr ? readExr(path, bytes, mostPixels)
                                     : readPng(path, std::move(bytes), mostPixels);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(path + ": does not fit into memory: use a smaller image");
    } catch (const std::exception& error) {
        std::string reason = error.what();
        std::replace(reason.begin(), reason.end(), '\n', ' ');
        throw Error(path + ": cannot be read as an image (" + reason + "): is it complete?");
    }
}

std::string encodeSrgb(const FloatImage& image, const std::string& name) {
    std::array<const std::vector<float>*, 3> planes{};
    for (size_t c = 0; c < 3; ++c) {
        const std::string channel(1, "RGB"[c]);
        planes[c] = image.find(channel);
        if (!planes[c]) throw Error(name + ": the image has no channel " + channel + ": write .exr instead");
    }
    std::string pixels(size_t(image.width) * image.height * 3, '\0');
    constexpr uint32_t kRows = 64; // that a thread encodes at a time
    const uint32_t portions = (image.height + kRows - 1) / kRows;
    WorkerPool pool(std::min(std::max(portions, 1u), WorkerPool::defaultSize()));
    pool.run(portions, [&](uint32_t portion) {
        const size_t first = size_t{portion} * kRows * image.width;
        const size_t end = std::min(first + size_t{kRows} * image.width, pixels.size() / 3);
        for (size_t i = first; i < end; ++i)
            for (size_t c = 0; c < 3; ++c)
                pixels[3 * i + c] = char(srgbByte((*planes[c])[i]));
    });
    return pixels;
}

std::string encodePng(const FloatImage& image, const std::string& name) {
    return writePng(encodeSrgb(image, name), image.width, image.height, 3, name);
}

std::string encodeImage(const std::string& path, const FloatImage& image, ExrType type,
                        ExrCompression compression) {
    ASSERT(image.width > 0 && image.height > 0 && image.channels.size() == image.planes.size());
    for (const std::vector<float>& plane : image.planes)
        ASSERT(plane.size() == size_t(image.width) * image.height);
    if (formatOf(path, Access::Write) == Format::Png) return encodePng(image, path);
    try {
        return encodeExr(path, image, type, compression);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const Error&) { // of who watches
        throw;
    } catch (const std::exception& error) {
        throw Error(path + ": cannot be encoded as OpenEXR: " + error.what());
    }
}

void writeImage(const std::string& path, const FloatImage& image, ExrType type, ExrCompression compression) {
    writeFileAtomically(path, encodeImage(path, image, type, compression));
}

void checkWritable(const std::string& path, uint64_t bytes) {
    formatOf(path, Access::Write);
    checkFileWritable(path, bytes);
}

} // namespace relume
