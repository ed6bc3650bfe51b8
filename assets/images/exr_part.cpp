#include "assets/images/exr_part.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/log.h"
#include "assets/base/portions.h"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <new>
#include <stdexcept>

namespace relume::exr {

bool MemoryInput::read(char c[], int n) {
    if (n < 0 || uint64_t(n) > bytes_.size() - at_) throw std::runtime_error("the file ends too early");
    std::memcpy(c, bytes_.data() + at_, size_t(n));
    at_ += uint64_t(n);
    return at_ < bytes_.size();
}

void MemoryInput::seekg(uint64_t position) {
    if (position > bytes_.size()) throw std::runtime_error("the file ends too early");
    at_ = position;
}

MemoryOutput::MemoryOutput(const char* name, uint64_t most) : OStream(name) {
    try {
        bytes.reserve(most);
    } catch (const std::bad_alloc&) { // it may be packed to less
    }
}

void MemoryOutput::write(const char c[], int n) {
    const size_t inside = std::min(size_t(n), bytes.size() - std::min(size_t(at_), bytes.size()));
    if (at_ > bytes.size()) bytes.resize(at_);
    std::memcpy(bytes.data() + at_, c, inside);
    bytes.append(c + inside, size_t(n) - inside);
    at_ += uint64_t(n);
}

std::string readBytes(const std::string& path) {
    std::error_code code;
    if (!std::filesystem::exists(path, code)) throw Error(path + ": no such file: check the name");
    RegularFile file(path, "name an image");
    std::string bytes(file.size(), '\0');
    file.read(bytes.data(), bytes.size());
    return bytes;
}

void checkPixels(const std::string& path, uint64_t width, uint64_t height, uint64_t mostPixels) {
    if (width * height <= mostPixels) return;
    throw Error(path + ": has " + std::to_string(width) + " x " + std::to_string(height) +
                " pixels, more than " + std::to_string(mostPixels >> 20) + " Mpixel: scale it down");
}

FloatImage imageOf(const Imf::Header& header, const std::string& path, uint64_t mostPixels) {
    const Imath::Box2i window = header.dataWindow();
    const auto width = uint32_t(window.max.x - window.min.x + 1);
    const auto height = uint32_t(window.max.y - window.min.y + 1);
    checkPixels(path, width, height, mostPixels);

    FloatImage image;
    image.width = width;
    image.height = height;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        image.channels.emplace_back(c.name());
    const auto rank = [](const std::string& name) { return std::string("RGBA").find(name); };
    std::stable_sort(image.channels.begin(), image.channels.end(),
                     [&](const std::string& a, const std::string& b) {
                         return (a.size() == 1 ? rank(a) : std::string::npos) <
                                (b.size() == 1 ? rank(b) : std::string::npos);
                     });
    for (auto a = header.begin(); a != header.end(); ++a) {
        const std::string name = a.name();
        if (name == "name" || name == "type") continue; // OpenEXR's own, of files of several parts
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            image.attributes[name] = text->value();
    }
    return image;
}

namespace {

std::mutex threadsMutex;
int threadUsers = 0;

Imf::Compression codecOf(ExrCompression compression) {
    switch (compression) {
    case ExrCompression::Off:
        return Imf::NO_COMPRESSION;
    case ExrCompression::Rle:
        return Imf::RLE_COMPRESSION;
    case ExrCompression::Zips:
        return Imf::ZIPS_COMPRESSION;
    case ExrCompression::Zip:
        return Imf::ZIP_COMPRESSION;
    case ExrCompression::Piz:
        return Imf::PIZ_COMPRESSION;
    }
    ASSERT(false);
    return Imf::ZIP_COMPRESSION;
}

constexpr size_t kRoundedAtATime = size_t{1} << 16; // numbers, by a thread

// Rounds so many numbers to half and cuts what is beyond its range. Returns how many were cut.
template<typename Get, typename Set>
size_t roundEach(WorkerPool& pool, size_t count, const Get& get, const Set& set) {
    std::atomic<size_t> cut{0};
    runPortions(pool, count, kRoundedAtATime, [&](size_t begin, size_t end) {
        size_t own = 0;
        for (size_t i = begin; i < end; ++i) {
            const float value = get(i);
            const bool tooLarge = std::isfinite(value) && std::abs(value) > float(HALF_MAX);
            own += tooLarge;
            set(i, half(tooLarge ? std::copysign(float(HALF_MAX), value) : value));
        }
        cut += own;
    });
    return cut;
}

} // namespace

ExrThreads::ExrThreads() {
    const std::lock_guard lock(threadsMutex);
    if (threadUsers++ == 0) Imf::setGlobalThreadCount(int(WorkerPool::defaultSize()));
}

ExrThreads::~ExrThreads() {
    const std::lock_guard lock(threadsMutex);
    if (--threadUsers == 0) Imf::setGlobalThreadCount(0);
}

int ExrThreads::rows() {
    constexpr int kRowsAtATime = 32, kLeast = 4; // rows, and how many times that
    return kRowsAtATime * std::max(kLeast, 2 * Imf::globalThreadCount());
}

Imf::Header headerOf(const FloatImage& image, ExrType type, ExrCompression compression) {
    Imf::Header header(int(image.width), int(image.height));
    header.compression() = codecOf(compression);
    for (const auto& [name, value] : image.attributes)
        header.insert(name, Imf::StringAttribute(value));
    for (const std::string& channel : image.channels)
        header.channels().insert(channel, Imf::Channel(type == ExrType::Half ? Imf::HALF : Imf::FLOAT));
    return header;
}

uint64_t mostBytes(const FloatImage& image, ExrType type) {
    const uint64_t each = type == ExrType::Half ? sizeof(half) : sizeof(float);
    constexpr uint64_t kHeader = 1 << 16, kLine = 32; // with its place in the tables
    const uint64_t pixels = uint64_t{image.width} * image.height * image.channels.size() * each;
    return pixels + image.height * kLine + kHeader;
}

size_t toHalf(WorkerPool& pool, std::span<const float> plane, half* halves) {
    return roundEach(
        pool, plane.size(), [&](size_t i) { return plane[i]; },
        [&](size_t i, half value) { halves[i] = value; });
}

size_t roundToHalf(WorkerPool& pool, std::span<float> plane) {
    return roundEach(
        pool, plane.size(), [&](size_t i) { return plane[i]; },
        [&](size_t i, half value) { plane[i] = value; });
}

void PartWriter::warnAboutCut(const std::string& path) const {
    exr::warnAboutCut(path, cut_);
}

void warnAboutCut(const std::string& path, size_t cut) {
    if (cut > 0)
        spdlog::warn("{}: {} values beyond 65504 were cut to fit half: write float instead", path, cut);
}

} // namespace relume::exr
