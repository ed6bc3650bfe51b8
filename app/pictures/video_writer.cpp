#include "app/pictures/video_writer.h"

#include "assets/base/error.h"
#include "assets/images/image_file.h"

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

// Finds a program as a shell does; "" where there is none.
std::string findProgram(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::string program = (folder.empty() ? "." : folder) + "/" + name;
        std::error_code code;
        if (access(program.c_str(), X_OK) == 0 && fs::is_regular_file(program, code)) return program;
    }
    return "";
}

// The file that ffmpeg writes has this descriptor in ffmpeg, which goes to and fro in it and opens it a
// second time.
constexpr int kVideoDescriptor = 3;

void closeDescriptor(int& descriptor) {
    if (descriptor >= 0) close(descriptor);
    descriptor = -1;
}

std::string lastLine(int descriptor) {
    std::string text, last;
    char bytes[4096];
    off_t offset = 0;
    for (ssize_t count = 0; (count = pread(descriptor, bytes, sizeof(bytes), offset)) > 0; offset += count)
        text.append(bytes, static_cast<size_t>(count));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (!line.empty()) last = line;
    return last;
}

// Returns arguments for H.264 that every player takes: colours at half the resolution, in the standard of
// high-definition television, and marked so.
std::vector<std::string> ffmpegArguments(const FrameWriter::Desc& desc) {
    // This is the constant rate factor of x264, where 0 is lossless and 23 its default: a time lapse shows
    // noise, which low factors keep.
    constexpr const char* kQuality = "16";
    return {"ffmpeg",
            "-hide_banner",
            "-nostdin",
            "-loglevel",
            "error",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
            "-s",
            fmt::format("{}x{}", desc.width, desc.height),
            "-r",
            fmt::format("{}", desc.rate),
            "-i",
            "pipe:0",
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
            "-colorspace",
            "bt709",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "iec61966-2-1",
            "-c:v",
            "libx264",
            "-crf",
            kQuality,
            "-movflags",
            "+faststart",
            "-f",
            "mp4",
            "-y",
            fmt::format("file:/proc/self/fd/{}", kVideoDescriptor)};
}

} // namespace

VideoWriter::VideoWriter(const Desc& desc) : desc_(desc), program_(findProgram("ffmpeg")) {
    checkFileWritable(desc.path, 0);
    if (program_.empty()) {
        throw Error(desc.path +
                    ": a video needs ffmpeg, which is not installed: run 'apt-get install ffmpeg', "
                    "or name a folder for the frames");
    }
}

VideoWriter::~VideoWriter() {
    closeDescriptor(pipe_);
    if (child_ > 0) {
        kill(child_, SIGKILL);
        wait();
    }
    closeDescriptor(log_);
}

// Starts ffmpeg beside us, in a process group of its own, because Ctrl-C is for us.
void VideoWriter::start() {
    file_.emplace(desc_.path);
    int ends[2] = {-1, -1};
    // It is a socket because a write to one can fail instead of raising SIGPIPE.
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw Error(desc_.path + ": no socket for ffmpeg: " + std::strerror(errno) +
                    ": close other programs");
    pipe_ = ends[0];
    log_ = memfd_create("ffmpeg", MFD_CLOEXEC);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, log_, STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&actions, file_->descriptor(), kVideoDescriptor);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::vector<std::string> arguments = ffmpegArguments(desc_);
    std::vector<char*> argv;
    for (std::string& argument : arguments)
        argv.push_back(argument.data());
    argv.push_back(nullptr);
    const int error = posix_spawn(&child_, program_.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error == 0) return;
    child_ = 0;
    throw Error(desc_.path + ": " + program_ + " does not start: " + std::strerror(error) +
                ": name a folder for the frames");
}

int VideoWriter::wait() {
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = 0;
    return status;
}

void VideoWriter::fail() {
    closeDescriptor(pipe_);
    if (child_ > 0) wait();
    const std::string line = lastLine(log_);
    throw Error(desc_.path + ": ffmpeg failed" + (line.empty() ? "" : ": " + line) +
                ": name a folder for the frames");
}

void VideoWriter::send() {
    for (size_t sent = 0; sent < pixels_.size();) {
        const ssize_t count = ::send(pipe_, pixels_.data() + sent, pixels_.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail();
        sent += static_cast<size_t>(count);
    }
}

void VideoWriter::write(const FloatImage& frame, uint32_t times) {
    if (count_ == 0) start();
    pixels_ = encodeSrgb(frame, desc_.path);
    for (uint32_t i = 0; i < times; ++i, ++count_)
        send();
}

std::string VideoWriter::finish() {
    for (int more = static_cast<int>(std::lround(desc_.hold * desc_.rate)) - 1; more > 0; --more)
        send();
    closeDescriptor(pipe_);
    if (wait() != 0) fail();
    if (desc_.nextName) return file_->commitAnew(desc_.nextName);
    file_->commit();
    return desc_.path;
}

} // namespace relume
