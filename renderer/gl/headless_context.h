#pragma once

#include <string>

namespace relume::gl {

/// Owns an OpenGL 4.5 core context without a window or a display, made by EGL and current on the thread that
/// made it; move it to no other. It takes a GPU where there is one, else Mesa's software device.
class HeadlessContext {
public:
    struct Desc {
        bool debug = false; // the driver checks more and tells more, and is slower
    };
    explicit HeadlessContext(const Desc& desc); // throws Error naming what is missing and the remedy
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    /// Returns the EGL platform that it came from: "device" or "surfaceless".
    const std::string& platform() const { return platform_; }

private:
    void* display_ = nullptr; // EGLDisplay
    void* context_ = nullptr; // EGLContext
    std::string platform_;
};

} // namespace relume::gl
