#pragma once

#include <optional>
#include <string>

#include <sys/types.h>

#include "app/pictures/frame_writer.h"
#include "assets/base/file_write.h"

namespace relume {

/// Writes an MP4 by ffmpeg, which runs beside us and is given the frames as they come. The file has its name
/// once it is whole.
class VideoWriter final : public FrameWriter {
public:
    explicit VideoWriter(const Desc& desc); // throws Error when there is no ffmpeg
    ~VideoWriter() override;
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    void write(const FloatImage& frame, uint32_t times) override;
    std::string finish() override;
    bool keepsFrames() const override { return false; }

private:
    void start();
    void send();
    int wait();
    [[noreturn]] void fail();

    Desc desc_;
    std::string program_, pixels_; // pixels_: of the last frame
    std::optional<AtomicFile> file_;
    pid_t child_ = 0; // 0: not running
    int pipe_ = -1, log_ = -1;
};

} // namespace relume
