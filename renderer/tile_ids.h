#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/gl/readback.h"
#include "renderer/id_pass.h"

namespace relume {

/// Tells which tiles of 8 x 8 lightmap texels a camera sees, by a small picture of their numbers. Nothing
/// waits for the device.
class TileIds {
public:
    /// Asks for the tiles, in place of what was asked for before. `aspect` is width / height of the picture
    /// that the user sees, `lightmapSize` is an edge [texels]. Throws Error when the shader does not compile.
    void request(const SceneGpu& scene, const ViewCamera& camera, float aspect, uint32_t lightmapSize);
    bool pending() const { return readback_.pending(); }
    /// Returns the tiles once after each request, as soon as they are there: row x tiles per row + column,
    /// ascending, each once.
    std::optional<std::vector<uint32_t>> poll();

    /// Compiles its programs again. Throws Error and keeps the old ones when one fails.
    void reload() { pass_.reload(); }

private:
    void resize(uint32_t height);

    IdPass pass_;
    gl::Framebuffer picture_;
    gl::Readback readback_;
};

} // namespace relume
