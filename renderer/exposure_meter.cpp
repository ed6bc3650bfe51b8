#include "renderer/exposure_meter.h"

#include "renderer/exposure.h"

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace relume {
namespace {

// There are so many cells along each side: few to read back, while the picture's parts are still told apart.
constexpr uint32_t kMeterCells = 64;
constexpr size_t kBytes = sizeof(glm::vec4) * kMeterCells * kMeterCells;

} // namespace

ExposureMeter::ExposureMeter()
    : cells_({.width = kMeterCells, .height = kMeterCells, .color = GL_RGBA32F, .name = "meter"}),
      readback_({.size = kBytes, .name = "meter"}) {
    program(0); // what is wrong with it shows now
}

const gl::Program& ExposureMeter::program(uint32_t samples) {
    return programs_.get(samples, [&]() -> gl::Program::Desc {
        return {.vertex = "gl/screen.vert",
                .fragment = "gl/meter.frag",
                .definitions = {"SAMPLES=" + std::to_string(samples),
                                "kMeterCells=" + std::to_string(kMeterCells)},
                .name = "meter"};
    });
}

void ExposureMeter::measure(const gl::Framebuffer& picture, uint32_t samples, float meterScale) {
    meterScale_ = meterScale;
    glBindTextureUnit(0, picture.color().get());
    screen_.draw(program(samples), cells_.get(), kMeterCells, kMeterCells);
    readback_.request(cells_, GL_RGBA, GL_FLOAT);
}

std::optional<float> ExposureMeter::result(bool wait) {
    if (!readback_.pending()) return std::nullopt;
    const auto bytes = wait ? readback_.wait() : readback_.poll();
    if (!bytes) return std::nullopt;
    std::vector<glm::vec4> cells(size_t{kMeterCells} * kMeterCells);
    std::memcpy(cells.data(), bytes->data(), kBytes);
    return automaticExposure(cells) + std::log2(meterScale_);
}

} // namespace relume
