#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>

#include "assets/base/watch.h"
#include "assets/base/worker_pool.h"
#include "assets/images/float_image.h"

// Here is what readers and writers of OpenEXR files of one part and of several parts have in common. Whatever
// is wrong with a file is thrown as std::exception.
namespace relume::exr {

class MemoryInput : public Imf::IStream {
public:
    MemoryInput(const char* name, const std::string& bytes) : IStream(name), bytes_(bytes) {}
    bool read(char c[], int n) override;
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t position) override;

private:
    const std::string& bytes_;
    uint64_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
public:
    /// Has addresses for so many bytes, where there are as many; memory comes as they are written.
    MemoryOutput(const char* name, uint64_t most);
    void write(const char c[], int n) override;
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t position) override { at_ = position; }

    std::string bytes;

private:
    uint64_t at_ = 0;
};

/// Reads the whole file.
std::string readBytes(const std::string& path);

/// Throws Error, naming the file, where an image has more than `mostPixels`.
void checkPixels(const std::string& path, uint64_t width, uint64_t height, uint64_t mostPixels);

/// Returns the image that a header tells of, without its pixels; channels are R, G, B, A first, then by name.
/// Throws Error where it has more than `mostPixels`.
FloatImage imageOf(const Imf::Header& header, const std::string& path, uint64_t mostPixels);

/// Returns the header that an image is written with.
Imf::Header headerOf(const FloatImage& image, ExrType type, ExrCompression compression);

/// Returns how many bytes an image takes in a file at the most, but for what its attributes take.
uint64_t mostBytes(const FloatImage& image, ExrType type);

/// Reads the pixels of an Imf::InputFile or Imf::InputPart. They take memory as they come: what a header
/// claims and the file does not have costs none.
template<class Part>
FloatImage readPart(Part& part, const std::string& path, uint64_t mostPixels) {
    constexpr int kLines = 256; // whole chunks of all codecs
    FloatImage image = imageOf(part.header(), path, mostPixels);
    const Imath::Box2i window = part.header().dataWindow();
    Imf::FrameBuffer frame;
    image.planes.resize(image.channels.size());
    for (size_t c = 0; c < image.channels.size(); ++c) {
        image.planes[c].reserve(size_t(image.width) * image.height);
        frame.insert(image.channels[c], Imf::Slice::Make(Imf::FLOAT, image.planes[c].data(), window));
    }
    part.setFrameBuffer(frame);
    for (int done = 0; done < int(image.height);) {
        const int lines = std::min(kLines, int(image.height) - done);
        for (std::vector<float>& plane : image.planes)
            plane.resize(plane.size() + size_t(image.width) * size_t(lines));
        part.readPixels(window.min.y + done, window.min.y + done + lines - 1);
        done += lines;
    }
    return image;
}

/// Rounds to half on all threads of the pool and cuts what is beyond its range; `halves` has room for as many
/// numbers as the plane has. Returns how many were cut.
size_t toHalf(WorkerPool& pool, std::span<const float> plane, half* halves);
/// Does the same in place.
size_t roundToHalf(WorkerPool& pool, std::span<float> plane);

/// As long as it lives, OpenEXR files that are made compress on as many threads as a WorkerPool has. There
/// are no threads afterwards: they would rest all the time, and a process that forks would wait for them. The
/// bytes of a file are the same.
class ExrThreads {
public:
    ExrThreads();
    ~ExrThreads();
    ExrThreads(const ExrThreads&) = delete;
    ExrThreads& operator=(const ExrThreads&) = delete;
    /// Returns how many rows keep all cores busy: OpenEXR compresses up to 32 at a time.
    static int rows();
};

/// Writes the pixels of images as values of one type, and counts those that it had to cut for it.
class PartWriter {
public:
    explicit PartWriter(ExrType type) {
        if (type == ExrType::Half) pool_.emplace(0);
    }

    /// Writes them to an Imf::OutputFile or Imf::OutputPart.
    template<class Part>
    void write(Part& part, const FloatImage& image) {
        const Imf::PixelType pixelType = pool_ ? Imf::HALF : Imf::FLOAT;
        Imf::FrameBuffer frame;
        if (pool_) halves_.resize(std::max(halves_.size(), image.channels.size()));
        for (size_t c = 0; c < image.channels.size(); ++c) {
            const void* const data = pool_ ? halvesOf(image.planes[c], halves_[c])
                                           : static_cast<const void*>(image.planes[c].data());
            frame.insert(image.channels[c], Imf::Slice::Make(pixelType, static_cast<const char*>(data),
                                                             part.header().dataWindow()));
        }
        part.setFrameBuffer(frame);
        // The rows are written in portions, between which the watch can be told how far the job is, and can
        // end it.
        const int rows = ExrThreads::rows();
        for (int left = int(image.height); left > 0; left -= rows) {
            tellWatch("writing", 1.0 - double(left) / image.height);
            part.writePixels(std::min(left, rows));
        }
    }
    /// Warns where values were cut for the file of this name.
    void warnAboutCut(const std::string& path) const;

private:
    const void* halvesOf(const std::vector<float>& plane, std::vector<half>& halves) {
        halves.resize(plane.size());
        cut_ += toHalf(*pool_, plane, halves.data());
        return halves.data();
    }

    ExrThreads threads_;
    std::optional<WorkerPool> pool_;        // rounds to half; none where values stay as they are
    std::vector<std::vector<half>> halves_; // of the image before, whose memory serves the next one
    size_t cut_ = 0;
};

void warnAboutCut(const std::string& path, size_t cut);

} // namespace relume::exr
