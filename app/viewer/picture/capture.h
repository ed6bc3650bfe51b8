#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/pictures/frame_writer.h"

namespace relume {

/// The pixels of a picture as OpenGL gives them: RGBA of 8 bits, the lowest row first.
struct Pixels {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba;
    std::vector<std::string> caption = {}; // lines that are written into the picture
};
/// Reads the pixels of a framebuffer; 0 is the window's back buffer.
Pixels readPixels(uint32_t framebuffer, uint32_t width, uint32_t height);

/// Returns a name with today's date, "relume_2026-11-21_001.png", whose number no file or folder in the
/// folder has, with this ending or another. The ending is ".png", or "" for a folder.
std::string captureName(const std::string& folder, const std::string& ending);

/// Writes screenshots and recordings on a thread of its own. Calls return at once; frames that come faster
/// than they are written are left out.
class Capture {
public:
    static constexpr double kRate = 30; // [frames/s] of a recording

    Capture();
    ~Capture(); // writes what waits
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;

    /// Writes a screenshot. The log tells where it went, or what went wrong.
    void screenshot(Pixels pixels, const std::string& folder);
    /// Records from the next frame on: an MP4 where there is ffmpeg, else PNG frames in a folder.
    void start(const std::string& folder, double now);
    void stop(double now);
    bool recording() const { return recording_; }
    /// Tells whether a frame that is shown from `now` on would be taken: ask before reading pixels.
    bool wants(double now) const;
    /// Adds the frame that is on screen from `now` [s] on. A frame of another size than the first ends the
    /// recording.
    void frame(Pixels pixels, double now);

private:
    struct Job {
        Pixels pixels = {};
        std::string path = {}; // a folder
        uint32_t times = 0;    // how often a recording shows it; 0: a screenshot
        bool ends = false;     // it ends the recording

        bool isScreenshot() const { return times == 0 && !ends; }
    };
    void push(Job job);
    void work();
    void write(const Job& job);
    void beginRecording(const Job& job);
    uint32_t timesUntil(double now) const;

    // These belong to the calling thread.
    bool recording_ = false;
    double begun_ = 0, lastTime_ = 0;
    uint64_t sent_ = 0;             // frames of the recording, repeated ones counted
    std::optional<Pixels> waiting_; // the newest frame: how long it is shown is not known yet
    std::string folder_;
    // These belong to both threads.
    mutable std::mutex mutex_;
    std::condition_variable news_;
    std::deque<Job> jobs_;
    bool quit_ = false;
    // These belong to the writing thread.
    std::unique_ptr<FrameWriter> writer_;
    bool failed_ = false;
    std::thread thread_;
};

} // namespace relume
