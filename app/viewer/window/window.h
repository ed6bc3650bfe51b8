#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/base/error.h"

struct GLFWwindow;

namespace relume {

/// Something that happened to a window.
struct WindowEvent {
    enum class Kind { Key, Letter, Button, Cursor, Scroll, Drop, Focus, Enter, Redraw };
    Kind kind = Kind::Redraw;
    // The code is GLFW_KEY_ of the letter on the user's keyboard (Key), Unicode (Letter) or
    // GLFW_MOUSE_BUTTON_ (Button).
    int code = 0;
    int place = 0;                       // Key: GLFW_KEY_ of the same place on a US keyboard
    int scancode = 0;                    // Key
    int mods = 0;                        // GLFW_MOD_
    bool pressed = false;                // Key, Button; Focus, Enter: it came in
    bool repeated = false;               // Key: it is held
    glm::dvec2 at{0.0};                  // Button, Cursor: [screen coordinates]; Scroll: steps
    std::vector<std::string> paths = {}; // Drop
};

/// Tells that there can be no window: no display, or none with OpenGL 4.5.
class NoWindow : public Error {
public:
    using Error::Error;
};

/// A window with an OpenGL 4.5 core context, which is current on the thread that made it. There is one at a
/// time; all calls but wake() are for that thread.
class Window {
public:
    struct Desc {
        uint32_t width = 1280, height = 800; // [screen coordinates], of which the monitor's scale makes more
        std::string title;
        bool debug = false; // the driver checks more and tells more, and is slower
    };
    explicit Window(const Desc& desc); // shows it; throws NoWindow naming what is missing and the remedy
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    GLFWwindow* handle() const { return window_; }
    bool closing() const;
    void close();
    void keepOpen(); // takes back close(), or what the user did in its place
    bool minimised() const;
    glm::uvec2 size() const;                             // [pixels], of what is drawn into
    glm::uvec2 extent() const;                           // [screen coordinates]
    float contentScale() const { return contentScale_; } // of text and controls
    double refreshRate() const { return refreshRate_; }  // [1/s] of the monitor, 60 where unknown
    void setTitle(const std::string& title);
    void copyText(const std::string& text) const; // into the clipboard
    void setVsync(bool on);

    /// Waits at most so long [s], 0: not at all, for something to happen, and returns what has happened so
    /// far.
    std::vector<WindowEvent> wait(double seconds);
    void swap();
    /// Ends wait(). Any thread may call it.
    static void wake();

private:
    void installCallbacks();

    GLFWwindow* window_ = nullptr;
    float contentScale_ = 1;
    double refreshRate_ = 60;
    std::optional<bool> vsync_; // as it was set last
    glm::dvec2 cursor_{0.0};    // [screen coordinates], where the newest event saw it
    std::vector<WindowEvent> events_;
};

} // namespace relume
