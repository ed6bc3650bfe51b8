#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "renderer/gl/buffer.h"
#include "renderer/gl/vertex_array.h"
#include "renderer/version.h"

namespace relume {

/// Holds lines in a scene, in OpenGL's memory. What is behind surfaces shines through faintly.
class LineDraw {
public:
    struct Segment {
        glm::vec3 from{0.0f}, to{0.0f}; // [m], world space
        glm::vec3 color{1.0f};          // as displayed
    };
    explicit LineDraw(std::span<const Segment> segments); // throws Error when it does not fit

    uint32_t vertexCount() const { return vertexCount_; }
    const gl::VertexArray& vertexArray() const { return vertexArray_; }
    uint64_t version() const { return version_; }

private:
    uint32_t vertexCount_ = 0;
    uint64_t version_ = newVersion();
    gl::Buffer vertices_;
    gl::VertexArray vertexArray_;
};

/// Holds boxes of one size in OpenGL's memory, drawn in a scene's place.
class VoxelDraw {
public:
    struct Desc {
        std::span<const glm::vec3> centres;     // [m], world space
        glm::vec3 edge{1.0f};                   // [m]
        std::span<const glm::vec3> colors = {}; // as displayed, one for each; empty: by the faces' normals
    };
    explicit VoxelDraw(const Desc& desc); // throws Error when it does not fit

    uint32_t count() const { return count_; }
    const glm::vec3& edge() const { return edge_; }
    bool colored() const { return colored_; }
    const gl::Buffer& voxels() const { return voxels_; } // as shaders/gl/voxel.vert reads them
    uint64_t version() const { return version_; }

private:
    uint32_t count_ = 0;
    glm::vec3 edge_{1.0f};
    bool colored_ = false;
    uint64_t version_ = newVersion();
    gl::Buffer voxels_;
};

} // namespace relume
