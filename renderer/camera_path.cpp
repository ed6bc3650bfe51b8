#include "renderer/camera_path.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

namespace relume {
namespace {

glm::quat orientationOf(const ViewCamera& camera) {
    const glm::vec3 ahead = forward(camera), side = right(camera);
    return glm::normalize(glm::quat_cast(glm::mat3(side, glm::cross(side, ahead), -ahead)));
}

// Returns the rotation vector of a unit quaternion, half its angle long.
glm::vec3 logarithm(const glm::quat& q) {
    const glm::vec3 v(q.x, q.y, q.z);
    const float length = glm::length(v);
    constexpr float kTiny = 1e-7f;
    return length > kTiny ? std::atan2(length, q.w) / length * v : v;
}
glm::quat exponential(const glm::vec3& v) {
    const float angle = glm::length(v);
    const float share = angle > 0.0f ? std::sin(angle) / angle : 1.0f;
    return {std::cos(angle), share * v};
}

// Returns the point that bends the way through `q` from `before` to `after`.
glm::quat bendAt(const glm::quat& before, const glm::quat& q, const glm::quat& after) {
    const glm::quat back = glm::conjugate(q);
    return q * exponential(-0.25f * (logarithm(back * after) + logarithm(back * before)));
}

glm::vec3 spline(const glm::vec3& before, const glm::vec3& from, const glm::vec3& to, const glm::vec3& after,
                 float s) {
    const glm::vec3 leaving = 0.5f * (to - before), arriving = 0.5f * (after - from);
    const float s2 = s * s, s3 = s2 * s;
    return (2 * s3 - 3 * s2 + 1) * from + (s3 - 2 * s2 + s) * leaving + (3 * s2 - 2 * s3) * to +
           (s3 - s2) * arriving;
}

/// The way through all stops.
class Way {
public:
    explicit Way(std::span<const ViewCamera> stops) : stops_(stops) {
        for (const ViewCamera& stop : stops) {
            glm::quat q = orientationOf(stop);
            if (!turns_.empty() && glm::dot(turns_.back(), q) < 0.0f) q = -q; // the shorter way around
            turns_.push_back(q);
        }
        bends_ = turns_; // nothing bends the way at its ends
        for (size_t i = 1; i < last(); ++i)
            bends_[i] = bendAt(turns_[i - 1], turns_[i], turns_[i + 1]);
    }

    /// Returns the camera at a time in [0, number of legs].
    ViewCamera at(double time) const {
        const size_t i = std::min(static_cast<size_t>(time), last() - 1);
        const auto s = static_cast<float>(time - static_cast<double>(i));
        const ViewCamera &from = stops_[i], &to = stops_[i + 1];
        if (s <= 0.0f) return from;
        if (s >= 1.0f) return to;
        ViewCamera camera = s < 0.5f ? from : to; // what kind of camera it is
        camera.eye =
            spline(stops_[i == 0 ? 0 : i - 1].eye, from.eye, to.eye, stops_[std::min(i + 2, last())].eye, s);
        const glm::quat turn =
            glm::normalize(glm::mix(glm::mix(turns_[i], turns_[i + 1], s),
                                    glm::mix(bends_[i], bends_[i + 1], s), 2.0f * s * (1.0f - s)));
        const float reach =
            glm::mix(glm::distance(from.eye, from.target), glm::distance(to.eye, to.target), s);
        camera.target = camera.eye - reach * (turn * glm::vec3(0, 0, 1));
        camera.up = turn * glm::vec3(0, 1, 0);
        camera.znear = glm::mix(from.znear, to.znear, s);
        if ((from.halfHeight > 0.0f) == (to.halfHeight > 0.0f)) {
            camera.yfov = glm::mix(from.yfov, to.yfov, s);
            camera.halfHeight = glm::mix(from.halfHeight, to.halfHeight, s);
            camera.zfar = glm::mix(from.zfar, to.zfar, s);
        }
        return camera;
    }

private:
    size_t last() const { return stops_.size() - 1; }

    std::span<const ViewCamera> stops_;
    std::vector<glm::quat> turns_, bends_;
};

} // namespace

std::vector<ViewCamera> cameraPath(std::span<const ViewCamera> stops, uint32_t count) {
    ASSERT(stops.size() > 1 && count > 1);
    const Way way(stops);
    std::vector<ViewCamera> cameras;
    for (uint32_t i = 0; i < count; ++i)
        cameras.push_back(way.at(static_cast<double>(stops.size() - 1) * i / (count - 1)));
    return cameras;
}

} // namespace relume
