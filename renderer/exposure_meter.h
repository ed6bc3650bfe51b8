#pragma once

#include <optional>

#include "renderer/gl/framebuffer.h"
#include "renderer/gl/program_cache.h"
#include "renderer/gl/readback.h"
#include "renderer/gl/screen.h"

namespace relume {

/// Measures which exposure a picture asks for.
class ExposureMeter {
public:
    ExposureMeter(); // throws Error when its shader does not compile

    /// Begins to measure a picture whose alpha holds the brightness of its light (meterCode of light times
    /// meterScale). `samples` is the number per pixel; 0: no multisampling.
    void measure(const gl::Framebuffer& picture, uint32_t samples, float meterScale);
    bool pending() const { return readback_.pending(); }
    /// Returns the result [EV] of the measurement that began last, once; with `wait` in any case where one is
    /// pending.
    std::optional<float> result(bool wait);

    /// Compiles its programs again. Throws Error and keeps the old ones when one fails.
    void reload() { programs_ = programs_.reloaded(); }

private:
    const gl::Program& program(uint32_t samples);

    gl::ProgramCache programs_; // by the number of samples
    gl::Screen screen_;
    gl::Framebuffer cells_;
    gl::Readback readback_;
    float meterScale_ = 1.0f; // of the picture that is measured
};

} // namespace relume
