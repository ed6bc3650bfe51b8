#include "assets/generate/finer.h"

#include "assets/base/error.h"

#include <array>
#include <utility>

namespace relume {
namespace {

using Corners = std::array<uint32_t, 3>;

/// A point of a triangle: its corners' shares, as whole numbers that add up to `parts`.
struct SplitPoint {
    uint32_t a, b, c;
};

bool isBefore(const glm::vec3& a, const glm::vec3& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

// Returns the corners in the order of their positions: an edge's points come of its ends in the same order in
// both of its triangles.
std::array<uint32_t, 3> inOrder(const std::vector<glm::vec3>& positions, const Corners& corners) {
    std::array<uint32_t, 3> order = {0, 1, 2};
    const auto sort = [&](size_t i, size_t j) {
        if (isBefore(positions[corners[order[j]]], positions[corners[order[i]]]))
            std::swap(order[i], order[j]);
    };
    sort(0, 1);
    sort(1, 2);
    sort(0, 1);
    return order;
}

/// Makes the triangles of one primitive.
class Splitter {
public:
    Splitter(const Primitive& from, uint32_t parts) : from_(from), parts_(parts) {
        to_ = from;
        to_.indices.clear();
    }

    Primitive split() {
        for (size_t i = 0; i + 2 < from_.indices.size(); i += 3)
            splitOne({from_.indices[i], from_.indices[i + 1], from_.indices[i + 2]});
        return std::move(to_);
    }

private:
    // Rows of points run from corner b to corner c, the last one being corner a.
    void splitOne(const Corners& corners) {
        const std::array<uint32_t, 3> order = inOrder(from_.positions, corners);
        std::vector<uint32_t> row, next;
        for (uint32_t a = 0; a <= parts_; ++a) {
            next.clear();
            for (uint32_t c = 0; c + a <= parts_; ++c)
                next.push_back(add(corners, order, {a, parts_ - a - c, c}));
            for (uint32_t k = 0; k + 1 < row.size(); ++k) {
                to_.indices.insert(to_.indices.end(), {next[k], row[k], row[k + 1]});
                if (k + 1 < next.size())
                    to_.indices.insert(to_.indices.end(), {next[k], row[k + 1], next[k + 1]});
            }
            row.swap(next);
        }
    }

    uint32_t add(const Corners& corners, const std::array<uint32_t, 3>& order, const SplitPoint& point) {
        const std::array<uint32_t, 3> counts = {point.a, point.b, point.c};
        for (size_t k = 0; k < 3; ++k)
            if (counts[k] == parts_) return corners[k];
        const auto between = [&](const auto& values, auto& to) {
            if (values.empty()) return;
            auto sum = static_cast<float>(counts[order[0]]) * values[corners[order[0]]];
            for (size_t k = 1; k < 3; ++k)
                if (counts[order[k]] > 0)
                    sum += static_cast<float>(counts[order[k]]) * values[corners[order[k]]];
            to.push_back(sum / static_cast<float>(parts_));
        };
        between(from_.positions, to_.positions);
        between(from_.normals, to_.normals);
        between(from_.texCoord0, to_.texCoord0);
        between(from_.texCoord1, to_.texCoord1);
        between(from_.texCoord2, to_.texCoord2);
        between(from_.colors, to_.colors);
        if (!to_.normals.empty()) {
            glm::vec3& normal = to_.normals.back();
            const float length = glm::length(normal);
            normal = length > 0.0f ? normal / length : from_.normals[corners[0]];
        }
        return static_cast<uint32_t>(to_.positions.size() - 1);
    }

    const Primitive& from_;
    Primitive to_;
    uint32_t parts_;
};

} // namespace

void splitTriangles(Scene& scene, uint32_t parts) {
    ASSERT(parts >= 1 && parts <= kMostParts);
    if (parts == 1) return;
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives)
            primitive = Splitter(primitive, parts).split();
}

} // namespace relume
