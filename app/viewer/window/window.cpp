#include "app/viewer/window/window.h"

#include "assets/base/log.h"
#include "renderer/gl/debug.h"

#include <atomic>
#include <cctype>
#include <cstdlib>
#include <utility>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr const char* kMend = "'relume bake' and 'relume shot' need no display";

std::atomic<bool> alive{false}; // GLFW is initialised: a late wake() must not reach it otherwise

std::string glfwReason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "unknown reason";
}

double readRefreshRate() {
    constexpr double kUsual = 60; // assumed for Xvfb, which tells 0
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
    return mode != nullptr && mode->refreshRate > 0 ? mode->refreshRate : kUsual;
}

[[noreturn]] void failWithoutDisplay() {
    const std::string reason = glfwReason();
    const bool named = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
    throw NoWindow(std::string("no window: ") +
                   (named ? reason : "there is no display (DISPLAY is not set)") + ": " + kMend);
}

[[noreturn]] void failWithoutContext() {
    const std::string reason = glfwReason();
    throw NoWindow("no window with OpenGL 4.5: " + reason +
                   ": bring the graphics driver up to date or use Mesa's software one "
                   "(LIBGL_ALWAYS_SOFTWARE=1); " +
                   kMend);
}

// Returns the key as the user's keyboard has letters and signs: Ctrl+Z is where Z is written.
int letterOf(int key, int scancode) {
    const bool moves = (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) || key == GLFW_KEY_COMMA ||
                       key == GLFW_KEY_PERIOD || key == GLFW_KEY_SLASH || key == GLFW_KEY_SEMICOLON ||
                       key == GLFW_KEY_LEFT_BRACKET || key == GLFW_KEY_RIGHT_BRACKET;
    if (!moves) return key;
    const char* name = glfwGetKeyName(key, scancode);
    if (name == nullptr || name[0] == '\0' || name[1] != '\0') return key;
    const auto letter = static_cast<unsigned char>(name[0]);
    return letter > ' ' && letter < 127 ? std::toupper(letter) : key;
}

} // namespace

Window::Window(const Desc& desc) {
#ifdef GLFW_PLATFORM // since 3.4 it would open Wayland's windows, which have no frame on all desktops
    const auto isSet = [](const char* name) { return std::getenv(name) != nullptr; };
    if (isSet("DISPLAY") || !isSet("WAYLAND_DISPLAY")) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
    if (glfwInit() != GLFW_TRUE) failWithoutDisplay();
    alive = true;
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, desc.debug ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0); // the scene has a depth buffer of its own
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "relume");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "relume");
    window_ = glfwCreateWindow(static_cast<int>(desc.width), static_cast<int>(desc.height),
                               desc.title.c_str(), nullptr, nullptr);
    try {
        if (window_ == nullptr) failWithoutContext();
        glfwMakeContextCurrent(window_);
        gl::requireOpenGl45();
    } catch (const Error& error) {
        alive = false;
        glfwTerminate();
        throw NoWindow(error.what());
    }
    gl::listenToDebugMessages();
    float scaleY = 1;
    glfwGetWindowContentScale(window_, &contentScale_, &scaleY);
    refreshRate_ = readRefreshRate();
    installCallbacks();
}

Window::~Window() {
    alive = false;
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::installCallbacks() {
    glfwSetWindowUserPointer(window_, this);
    static const auto add = [](GLFWwindow* window, WindowEvent event) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->events_.push_back(std::move(event));
    };
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int mods) {
        add(window, {.kind = WindowEvent::Kind::Key,
                     .code = letterOf(key, scancode),
                     .place = key,
                     .scancode = scancode,
                     .mods = mods,
                     .pressed = action != GLFW_RELEASE,
                     .repeated = action == GLFW_REPEAT});
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int mods) {
        // glfwGetCursorPos would tell where the cursor is by now: after a slow frame that is not where it was
        // pressed.
        add(window, {.kind = WindowEvent::Kind::Button,
                     .code = button,
                     .mods = mods,
                     .pressed = action == GLFW_PRESS,
                     .at = static_cast<Window*>(glfwGetWindowUserPointer(window))->cursor_});
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->cursor_ = {x, y};
        add(window, {.kind = WindowEvent::Kind::Cursor, .at = {x, y}});
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) {
        add(window, {.kind = WindowEvent::Kind::Scroll, .at = {x, y}});
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        add(window, {.kind = WindowEvent::Kind::Drop, .paths = {paths, paths + count}});
    });
    glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned letter) {
        add(window, {.kind = WindowEvent::Kind::Letter, .code = static_cast<int>(letter)});
    });
    glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int, int) { add(window, {}); });
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) { add(window, {}); });
    glfwSetWindowFocusCallback(window_, [](GLFWwindow* window, int in) {
        add(window, {.kind = WindowEvent::Kind::Focus, .pressed = in == GLFW_TRUE});
    });
    glfwSetCursorEnterCallback(window_, [](GLFWwindow* window, int in) {
        add(window, {.kind = WindowEvent::Kind::Enter, .pressed = in == GLFW_TRUE});
    });
    glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* window, float x, float) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->contentScale_ = x;
        add(window, {});
    });
}

bool Window::closing() const {
    return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void Window::close() {
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

void Window::keepOpen() {
    glfwSetWindowShouldClose(window_, GLFW_FALSE);
}

bool Window::minimised() const {
    const glm::uvec2 pixels = size();
    return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE || pixels.x == 0 || pixels.y == 0;
}

glm::uvec2 Window::size() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

glm::uvec2 Window::extent() const {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

void Window::copyText(const std::string& text) const {
    glfwSetClipboardString(window_, text.c_str());
}

void Window::setTitle(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}

void Window::setVsync(bool on) {
    if (vsync_ == on) return;
    vsync_ = on;
    glfwSwapInterval(on ? 1 : 0);
}

std::vector<WindowEvent> Window::wait(double seconds) {
    if (seconds > 0 && events_.empty())
        glfwWaitEventsTimeout(seconds);
    else
        glfwPollEvents();
    return std::exchange(events_, {});
}

void Window::swap() {
    glfwSwapBuffers(window_);
}

void Window::wake() {
    if (alive) glfwPostEmptyEvent();
}

} // namespace relume
