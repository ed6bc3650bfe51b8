#include "renderer/overlays.h"

#include "assets/base/error.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace relume {
namespace {

struct LineVertex { // what shaders/gl/line.vert reads
    glm::vec3 position, color;
};

uint32_t packColor(const glm::vec3& color) {
    uint32_t packed = 0;
    for (int c = 0; c < 3; ++c) {
        const float share = glm::clamp(color[c], 0.0f, 1.0f);
        packed |= static_cast<uint32_t>(std::lround(255.0f * share)) << (8 * c);
    }
    return packed;
}

} // namespace

LineDraw::LineDraw(std::span<const Segment> segments) {
    std::vector<LineVertex> vertices;
    vertices.reserve(2 * segments.size());
    for (const Segment& segment : segments) {
        vertices.push_back({segment.from, segment.color});
        vertices.push_back({segment.to, segment.color});
    }
    vertexCount_ = static_cast<uint32_t>(vertices.size());
    if (vertices.empty()) return;
    vertices_ = gl::Buffer::of<LineVertex>(vertices, "lines");
    const std::array<gl::VertexAttribute, 2> attributes = {{
        {3, GL_FLOAT, offsetof(LineVertex, position)},
        {3, GL_FLOAT, offsetof(LineVertex, color)},
    }};
    vertexArray_ = gl::VertexArray(
        {.vertices = &vertices_, .stride = sizeof(LineVertex), .attributes = attributes, .name = "lines"});
}

VoxelDraw::VoxelDraw(const Desc& desc)
    : count_(static_cast<uint32_t>(desc.centres.size())), edge_(desc.edge), colored_(!desc.colors.empty()) {
    ASSERT(desc.colors.empty() || desc.colors.size() == desc.centres.size());
    std::vector<glm::uvec4> voxels;
    voxels.reserve(desc.centres.size());
    for (size_t i = 0; i < desc.centres.size(); ++i) {
        const glm::vec3& centre = desc.centres[i];
        voxels.emplace_back(glm::floatBitsToUint(centre), colored_ ? packColor(desc.colors[i]) : 0);
    }
    if (!voxels.empty()) voxels_ = gl::Buffer::of<glm::uvec4>(voxels, "voxels");
}

} // namespace relume
