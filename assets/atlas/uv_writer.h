#pragma once

#include <vector>

#include "assets/atlas/chart_layout.h"
#include "assets/model/scene.h"

namespace relume {

/// The UVs of a mesh's triangle corners, and which chart each triangle belongs to.
struct CornerUvs {
    std::vector<glm::vec2> uv;   // 3 per triangle
    std::vector<uint32_t> chart; // per triangle, kNoNumber: no area
};

/// Returns the UVs of `triangles` triangles whose charts lie at `places`; `cells` of them are one unit.
CornerUvs cornerUvs(const std::vector<PlanarChart>& charts, const ChartPlace* places, double cells,
                    size_t triangles);

/// Returns the mesh with the UVs as TEXCOORD_1; a vertex that has several UVs becomes several.
Mesh withUvs(const Mesh& mesh, const CornerUvs& uvs);

/// Frees TEXCOORD_1 of meshes whose textures use it, by moving it to TEXCOORD_0 in copies of the materials.
class TexCoordMover {
public:
    explicit TexCoordMover(Scene& scene) : scene_(scene), copies_(scene.materials.size(), -1) {}
    /// Tells whether a mesh's textures leave it one of its two sets of UVs.
    bool canFree(const Mesh& mesh) const;
    void run(Mesh& mesh);

private:
    struct Uses {
        bool set[2] = {false, false};
    };
    Uses usesOf(const Primitive& primitive) const;

    Scene& scene_;
    std::vector<int> copies_; // of the scene's own materials, -1: none yet
};

} // namespace relume
