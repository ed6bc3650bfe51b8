#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "renderer/gl/buffer.h"
#include "renderer/version.h"

namespace relume {

/// Holds balls in a scene, in OpenGL's memory, each lit by the light that comes to its middle.
class BallDraw {
public:
    enum class Kind : uint32_t {
        Waiting, // its light is not known yet
        Lit,
        Inside, // within a wall: a colour of warning
    };
    struct Ball {
        glm::vec3 centre{0.0f}; // [m], world space
        float radius = 1.0f;    // [m], > 0
        Kind kind = Kind::Waiting;
        // Lighting [cd/m^2] on a surface with unit normal (x, y, z) is the sum of these times 1, y, z, x, xy,
        // yz, 3z^2 - 1, xz, x^2 - y^2.
        std::array<glm::vec3, 9> lighting = {};
    };
    explicit BallDraw(std::span<const Ball> balls); // throws Error when it does not fit

    uint32_t count() const { return count_; }
    const gl::Buffer& balls() const { return balls_; } // as shaders/gl/ball.vert reads them
    uint64_t version() const { return version_; }

private:
    uint32_t count_ = 0;
    uint64_t version_ = newVersion();
    gl::Buffer balls_;
};

} // namespace relume
