#include "app/viewer/picture/capture.h"

#include "app/pictures/make_frame_writer.h"
#include "app/viewer/window/path_completion.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/images/image_file.h"
#include "renderer/caption.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <set>
#include <system_error>

#include <epoxy/gl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostJobs = 6;  // pictures that wait: tens of megabytes
constexpr double kLongest = 600; // [s] that one picture stays in a recording

// Returns an image like readPicture() gives it, upper row first; with `even` it has an even number of pixels
// each way, as videos want it.
FloatImage imageOf(const Pixels& pixels, bool even) {
    const uint32_t width = even ? pixels.width & ~1u : pixels.width;
    const uint32_t height = even ? pixels.height & ~1u : pixels.height;
    std::array<float, 256> linear{};
    for (size_t i = 0; i < linear.size(); ++i)
        linear[i] = static_cast<float>(linearFromSrgb(static_cast<double>(i) / 255.0));
    FloatImage image{width, height, {}, {}, {}};
    for (size_t channel = 0; channel < 3; ++channel) {
        std::vector<float>& plane = image.add(std::array{"R", "G", "B"}[channel]);
        for (uint32_t y = 0; y < height; ++y) {
            const size_t source = size_t{pixels.height - 1 - y} * pixels.width;
            for (uint32_t x = 0; x < width; ++x)
                plane[size_t{y} * width + x] = linear[pixels.rgba[4 * (source + x) + channel]];
        }
    }
    if (!pixels.caption.empty()) drawCaption(image, pixels.caption);
    return image;
}

[[noreturn]] void failToMake(const std::string& folder, const std::error_code& code) {
    throw Error(folder + ": cannot be made: " + code.message() + ": set captureFolder in the preferences");
}

void makeFolders(const std::string& folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) failToMake(folder, code);
}

// Makes a folder of a name that no other viewer took, and returns it.
std::string makeFolderForFrames(const std::string& folder) {
    for (;;) {
        std::string name = captureName(folder, "");
        std::error_code code;
        if (fs::create_directory(name, code)) return name;
        if (code) failToMake(name, code);
    }
}

} // namespace

Pixels readPixels(uint32_t framebuffer, uint32_t width, uint32_t height) {
    Pixels pixels{width, height, std::vector<uint8_t>(size_t{4} * width * height), {}};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_UNSIGNED_BYTE,
                 pixels.rgba.data());
    return pixels;
}

std::string captureName(const std::string& folder, const std::string& ending) {
    const std::time_t time = std::time(nullptr);
    const std::string start = fmt::format("relume_{:%Y-%m-%d}_", fmt::localtime(time));
    int last = 0;
    std::error_code code;
    for (fs::directory_iterator entry(folder, code); !code && entry != fs::directory_iterator();
         entry.increment(code)) {
        const std::string name = entry->path().stem().string();
        if (!name.starts_with(start)) continue;
        int number = 0;
        for (size_t i = start.size(); i < name.size() && name[i] >= '0' && name[i] <= '9' && number < 1000000;
             ++i)
            number = 10 * number + (name[i] - '0');
        last = std::max(last, number);
    }
    return fmt::format("{}/{}{:03}{}", folder, start, last + 1, ending);
}

Capture::Capture() : thread_([this] { work(); }) {}

Capture::~Capture() {
    if (recording_) stop(lastTime_);
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
    }
    news_.notify_one();
    thread_.join();
}

void Capture::push(Job job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    news_.notify_one();
}

void Capture::screenshot(Pixels pixels, const std::string& folder) {
    push({.pixels = std::move(pixels), .path = folder});
}

void Capture::start(const std::string& folder, double now) {
    recording_ = true;
    begun_ = lastTime_ = now;
    sent_ = 0;
    waiting_.reset();
    folder_ = folder;
    spdlog::info("recording");
}

// Returns how often the waiting frame must be written when the next one comes now.
uint32_t Capture::timesUntil(double now) const {
    const double shown = std::min(now - begun_, static_cast<double>(sent_) / kRate + kLongest);
    const double due = std::floor(shown * kRate) - static_cast<double>(sent_);
    return due > 0 ? static_cast<uint32_t>(due) : 0;
}

bool Capture::wants(double now) const {
    if (!recording_) return false;
    const std::lock_guard lock(mutex_);
    return jobs_.size() < kMostJobs && (!waiting_ || timesUntil(now) > 0);
}

void Capture::frame(Pixels pixels, double now) {
    lastTime_ = now;
    if (waiting_ && (waiting_->width != pixels.width || waiting_->height != pixels.height)) {
        spdlog::warn("the recording ends here: its pictures cannot change their size");
        return stop(now);
    }
    if (waiting_) {
        const uint32_t times = timesUntil(now);
        push({.pixels = std::move(*waiting_), .path = folder_, .times = times});
        sent_ += times;
    }
    waiting_ = std::move(pixels);
}

void Capture::stop(double now) {
    recording_ = false;
    Job last{.path = folder_, .ends = true};
    if (waiting_) {
        last.times = std::max(timesUntil(now), 1u);
        last.pixels = std::move(*waiting_);
    }
    waiting_.reset();
    push(std::move(last));
}

void Capture::work() {
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            news_.wait(lock, [this] { return quit_ || !jobs_.empty(); });
            if (jobs_.empty()) return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        try {
            write(job);
        } catch (const std::exception& error) {
            spdlog::error("{}", error.what());
            if (!job.isScreenshot()) {
                failed_ = true; // one message per recording
                writer_.reset();
            }
        }
        if (job.ends) {
            writer_.reset();
            failed_ = false;
        }
    }
}

// Begins a video where there is ffmpeg, else a folder.
void Capture::beginRecording(const Job& job) {
    makeFolders(job.path);
    const auto nextName = [folder = job.path] { return captureName(folder, ".mp4"); };
    FrameWriter::Desc desc{.path = nextName(),
                           .nextName = nextName,
                           .width = job.pixels.width & ~1u,
                           .height = job.pixels.height & ~1u,
                           .rate = kRate};
    try {
        writer_ = makeFrameWriter(desc);
    } catch (const Error& error) {
        spdlog::info("{}", error.what());
        desc.path = makeFolderForFrames(job.path);
        writer_ = makeFrameWriter(desc);
    }
}

void Capture::write(const Job& job) {
    if (job.isScreenshot()) {
        makeFolders(job.path);
        const auto nextName = [&] { return captureName(job.path, ".png"); };
        AtomicFile file(nextName());
        file.write(encodePng(imageOf(job.pixels, false), job.path));
        spdlog::info("wrote {}", file.commitAnew(nextName));
        return;
    }
    if (failed_) return;
    if (!writer_ && job.times > 0) beginRecording(job);
    if (!writer_) return;
    // Frames in a folder are there to be looked at, so a picture that stays is one file.
    if (job.times > 0) writer_->write(imageOf(job.pixels, true), writer_->keepsFrames() ? 1 : job.times);
    if (!job.ends) return;
    const uint32_t count = writer_->count();
    const std::string path = writer_->finish();
    spdlog::info("wrote {} ({} frames)", path, count);
}

} // namespace relume
