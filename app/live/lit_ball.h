#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// The places at which a viewer looks at the light, beside surfaces.
struct BallRequest {
    std::optional<glm::vec3> ball = {}; // that a user drags [m]
    std::vector<glm::vec3> grid = {};   // of light probes [m]

    bool wanted() const { return ball || !grid.empty(); }
    bool operator==(const BallRequest&) const = default;
};

/// The light that comes to a place.
struct LitBall {
    glm::vec3 position{0.0f};               // [m]
    std::array<glm::vec3, 9> lighting = {}; // lightingPolynomial() [cd/m^2]
    bool inside = false;                    // within a wall
};

/// The answer to a request.
struct LitBalls {
    std::optional<LitBall> ball;
    std::vector<LitBall> grid;
    bool traced = false; // rays were asked for it; else the light alone has changed
    std::string remark;  // says why there is no light, and what helps; "": there is
};

} // namespace relume
