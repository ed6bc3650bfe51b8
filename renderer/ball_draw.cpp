#include "renderer/ball_draw.h"

#include <vector>

namespace relume {
namespace {

struct GpuBall {                       // what shaders/gl/ball.vert reads
    glm::vec4 place;                   // radius in w
    std::array<glm::vec4, 9> lighting; // the first one's w: its kind
};

} // namespace

BallDraw::BallDraw(std::span<const Ball> balls) : count_(static_cast<uint32_t>(balls.size())) {
    std::vector<GpuBall> packed;
    packed.reserve(balls.size());
    for (const Ball& ball : balls) {
        GpuBall& one = packed.emplace_back();
        one.place = glm::vec4(ball.centre, ball.radius);
        for (size_t i = 0; i < one.lighting.size(); ++i)
            one.lighting[i] = glm::vec4(ball.lighting[i], 0.0f);
        one.lighting[0].w = static_cast<float>(ball.kind);
    }
    if (!packed.empty()) balls_ = gl::Buffer::of<GpuBall>(packed, "balls");
}

} // namespace relume
