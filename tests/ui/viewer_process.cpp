#include "tests/ui/viewer_process.h"

#include "assets/base/error.h"
#include "tests/gpu/relume_process.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// The viewer says so when what it was sent is on the screen, with the number of inputs that it has taken.
constexpr std::string_view kSettled = "settled: ";

// Returns a key's name ("ctrl+F5") with the code of a function key, which X has on all keyboards, in place of
// it: newer xdotools press Alt along, as that is one of the ways to the key's symbol.
std::string withKeyCode(const std::string& name) {
    constexpr std::array kCodes = {67, 68, 69, 70, 71, 72, 73, 74, 75, 76, 95, 96}; // of F1 to F12
    const size_t key = name.rfind('+') + 1;
    for (size_t i = 0; i < kCodes.size(); ++i)
        if (name.substr(key) == "F" + std::to_string(i + 1))
            return name.substr(0, key) + std::to_string(kCodes[i]);
    return name;
}

[[noreturn]] void becomeRelume(const ViewerProcess::Desc& desc, int err) {
    const int nothing = open("/dev/null", O_RDWR);
    dup2(nothing, STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (desc.display.empty())
        unsetenv("DISPLAY");
    else
        setenv("DISPLAY", desc.display.c_str(), 1);
    unsetenv("WAYLAND_DISPLAY");
    // The viewer gets a home of its own, but finds the shaders that Mesa compiled for others: they take it a
    // second.
    if (const char* home = std::getenv("HOME"))
        setenv("MESA_SHADER_CACHE_DIR", (std::string(home) + "/.cache").c_str(), 0);
    setenv("HOME", desc.home.c_str(), 1);
    setenv("XDG_CONFIG_HOME", (desc.home + "/config").c_str(), 1);
    mkdir((desc.home + "/Pictures").c_str(),
          0755); // for its screenshots, which then lie with no other viewer's
    std::vector<char*> argv{const_cast<char*>(RELUME_BINARY)};
    for (const std::string& argument : desc.arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(RELUME_BINARY, argv.data());
    _exit(127);
}

} // namespace

ViewerProcess::ViewerProcess(const Desc& desc) : display_(desc.display) {
    std::array<int, 2> err{};
    if (pipe2(err.data(), O_CLOEXEC) != 0) throw Error("pipe failed");
    pid_ = fork();
    if (pid_ < 0) throw Error("fork failed");
    if (pid_ == 0) becomeRelume(desc, err[1]);
    close(err[1]);
    listener_ = std::thread([this, stream = err[0]] { listen(stream); });
}

ViewerProcess::~ViewerProcess() {
    if (!ended(0)) {
        kill(pid_, SIGKILL);
        ended(10);
    }
    listener_.join();
}

void ViewerProcess::listen(int stream) {
    std::array<char, 4096> bytes;
    for (ssize_t count = 0; (count = read(stream, bytes.data(), bytes.size())) > 0;) {
        const std::lock_guard lock(mutex_);
        output_.append(bytes.data(), static_cast<size_t>(count));
        more_.notify_all();
    }
    close(stream);
    const std::lock_guard lock(mutex_);
    closed_ = true;
    more_.notify_all();
}

bool ViewerProcess::waitFor(const std::function<bool()>& there, double seconds) {
    std::unique_lock lock(mutex_);
    more_.wait_until(lock, after(seconds), [&] { return there() || closed_; });
    return there();
}

bool ViewerProcess::says(const std::string& text, double seconds) {
    return waitFor([&] { return output_.find(text, mark_) != std::string::npos; }, seconds);
}

bool ViewerProcess::shows(const std::string& text, double seconds) {
    return waitFor(
        [&] {
            const size_t at = output_.find(text, mark_);
            return at != std::string::npos && output_.find(kSettled, at) != std::string::npos;
        },
        seconds);
}

// The inputs that it had taken when what is on the screen had settled last.
uint64_t ViewerProcess::inputs() {
    const size_t at = output_.rfind(kSettled);
    return at == std::string::npos ? 0 : std::strtoull(output_.c_str() + at + kSettled.size(), nullptr, 10);
}

void ViewerProcess::settle() {
    waitFor([&] { return inputs() > inputsBefore_; }, patience_);
}

void ViewerProcess::mark() {
    const std::lock_guard lock(mutex_);
    mark_ = output_.size();
}

std::string ViewerProcess::output() {
    const std::lock_guard lock(mutex_);
    return output_;
}

bool ViewerProcess::window(double seconds) {
    const auto end = after(seconds);
    while (Clock::now() < end && runs()) {
        const ProcessResult found =
            runProgram("/usr/bin/env", {"DISPLAY=" + display_, "xdotool", "search", "--onlyvisible", "--pid",
                                        std::to_string(pid_), "--name", "Relume"});
        if (found.status == 0 && !found.out.empty()) {
            window_ = std::strtoul(found.out.c_str(), nullptr, 10);
            xdotool({"windowfocus", "--sync", std::to_string(window_)});
            return true;
        }
        std::this_thread::sleep_for(20ms);
    }
    return false;
}

void ViewerProcess::xdotool(const std::vector<std::string>& arguments) {
    {
        const std::lock_guard lock(mutex_);
        inputsBefore_ = inputs();
    }
    std::vector<std::string> all = {"DISPLAY=" + display_, "xdotool"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    runProgram("/usr/bin/env", all, nullptr, 20);
}

void ViewerProcess::keys(const std::vector<std::string>& names) {
    for (const std::string& name : names)
        xdotool({"key", "--delay", "40", withKeyCode(name)});
}

void ViewerProcess::press(const std::string& name) {
    xdotool({"keydown", name});
    settle();
    xdotool({"keyup", name});
    settle();
}

void ViewerProcess::type(const std::string& text) {
    xdotool({"type", "--delay", "20", text});
}

void ViewerProcess::moveTo(int x, int y) {
    if (std::pair(x, y) == cursor_) return; // no event would come of it
    cursor_ = {x, y};
    xdotool({"mousemove", "--window", std::to_string(window_), std::to_string(x), std::to_string(y)});
}

// ImGui takes one change of a button per frame: a frame must come between two.
void ViewerProcess::click(int x, int y, int button) {
    moveTo(x, y);
    settle();
    xdotool({"mousedown", std::to_string(button)});
    settle();
    xdotool({"mouseup", std::to_string(button)});
}

void ViewerProcess::drag(int fromX, int fromY, int toX, int toY, int button) {
    constexpr int kSteps = 8;
    moveTo(fromX, fromY);
    settle();
    xdotool({"mousedown", std::to_string(button)});
    settle();
    for (int i = 1; i <= kSteps; ++i)
        moveTo(fromX + (toX - fromX) * i / kSteps, fromY + (toY - fromY) * i / kSteps);
    settle();
    xdotool({"mouseup", std::to_string(button)});
}

void ViewerProcess::dragWhileItHangs(int fromX, int fromY, int toX, int toY) {
    moveTo(fromX, fromY);
    settle();
    kill(pid_, SIGSTOP);
    xdotool({"mousedown", "1"});
    moveTo(toX, toY);
    kill(pid_, SIGCONT);
    settle();
    xdotool({"mouseup", "1"});
}

void ViewerProcess::wheel(int clicks) {
    for (int i = 0; i < std::abs(clicks); ++i)
        xdotool({"click", clicks > 0 ? "4" : "5"});
}

void ViewerProcess::resize(int width, int height) {
    xdotool({"windowsize", std::to_string(window_), std::to_string(width), std::to_string(height)});
}

std::optional<int> ViewerProcess::ended(double seconds) {
    const auto end = after(seconds);
    while (!status_) {
        int status = 0;
        if (waitpid(pid_, &status, WNOHANG) == pid_)
            status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        else if (Clock::now() >= end)
            break;
        else
            std::this_thread::sleep_for(10ms);
    }
    return status_;
}

bool ViewerProcess::runs() {
    return !ended(0);
}

double ViewerProcess::statusMiB(std::string_view name) const {
    constexpr double kKibiInMebi = 1024;
    std::ifstream file("/proc/" + std::to_string(pid_) + "/status");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(name)) return std::strtod(line.c_str() + name.size(), nullptr) / kKibiInMebi;
    return 0;
}

// The rest of the newest line that begins so.
std::string ViewerProcess::last(std::string_view kind) {
    const std::lock_guard lock(mutex_);
    const size_t at = output_.rfind(kind);
    if (at == std::string::npos) return "";
    const size_t begin = at + kind.size();
    return output_.substr(begin, output_.find('\n', begin) - begin);
}

} // namespace relume
