#pragma once

#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace relume {

/// `relume view` on a virtual display, driven as a user would: by keys and a mouse.
class ViewerProcess {
public:
    struct Desc {
        std::string display;                // as DISPLAY has it, "": none
        std::string home;                   // of its preferences and pictures
        std::vector<std::string> arguments; // of relume
    };
    explicit ViewerProcess(const Desc& desc); // throws Error
    ~ViewerProcess();                         // ends it by force where it still runs
    ViewerProcess(const ViewerProcess&) = delete;
    ViewerProcess& operator=(const ViewerProcess&) = delete;

    /// Tells whether stderr has this text, or gets it within so many seconds: behind mark() only.
    [[nodiscard]] bool says(const std::string& text, double seconds = 20);
    /// Tells whether it says the text, and afterwards that what is on the screen has settled.
    [[nodiscard]] bool shows(const std::string& text, double seconds = 20);
    /// Waits until what was sent last is on the screen, so that the panels tell where their controls are now.
    /// Goes on where nothing comes of it for as long as the patience lasts: an input beside the window, say.
    void settle();
    void setPatience(double seconds) { patience_ = seconds; }
    /// What is said from now on.
    void mark();
    std::string output(); // all of stderr so far

    /// Waits for its window; false when there is none after so long.
    [[nodiscard]] bool window(double seconds = 20);
    unsigned long windowId() const { return window_; }
    /// Sends keys to the window, by xdotool's names: {"ctrl+z"}.
    void keys(const std::vector<std::string>& names);
    /// Presses a key, or keys joined by +, until a frame has seen it: quick ones may come and go between two.
    void press(const std::string& name);
    void type(const std::string& text);
    void moveTo(int x, int y); // within the window [pixels]
    void click(int x, int y, int button = 1);
    void drag(int fromX, int fromY, int toX, int toY, int button = 1);
    /// A drag of which it gets all but the release at once, as within a slow frame.
    void dragWhileItHangs(int fromX, int fromY, int toX, int toY);
    void wheel(int clicks); // above 0: up
    void resize(int width, int height);
    void xdotool(const std::vector<std::string>& arguments);

    /// Its exit status (128 + signal) when it ends within so many seconds.
    std::optional<int> ended(double seconds);
    bool runs();
    /// The memory that it has in use [MiB]: anonymous, which is its own and the drivers', or shared. The
    /// software device keeps its memory in the latter.
    double anonymousMiB() const { return statusMiB("RssAnon:"); }
    double sharedMiB() const { return statusMiB("RssShmem:"); }
    /// The device memory that keeps links [MiB], as it told last.
    double linksMiB() { return std::strtod(last("links: ").c_str(), nullptr); }
    /// The state of the bake, as it told last: "paused".
    std::string phase() { return last("bake: "); }
    /// Returns the control that the keyboard is at.
    std::string focus() { return last("focus: "); }
    pid_t pid() const { return pid_; }

private:
    void listen(int stream);
    uint64_t inputs();
    std::string last(std::string_view kind);
    double statusMiB(std::string_view name) const;
    bool waitFor(const std::function<bool()>& there, double seconds);

    std::string display_;
    pid_t pid_ = -1;
    unsigned long window_ = 0;
    std::optional<int> status_;
    std::thread listener_;
    std::mutex mutex_;
    std::condition_variable more_;
    std::string output_;
    size_t mark_ = 0;
    bool closed_ = false;
    double patience_ = 20;               // [s]
    uint64_t inputsBefore_ = 0;          // what it had taken when the last input was sent
    std::pair<int, int> cursor_{-1, -1}; // where the cursor was sent to [pixels]
};

} // namespace relume
