#pragma once

#include <map>
#include <optional>
#include <vector>

#include "app/live/live_bake.h"
#include "renderer/gl/texture.h"
#include "renderer/surface_ids.h"

namespace relume {

/// A small picture of what each light lights, with all bounces, as the camera saw the scene when it rested
/// last. Each is exposed by itself: a weak light's shows as much as a strong one's. Belongs to the current
/// OpenGL context.
class LightPreviews {
public:
    using Surfaces = std::vector<SurfaceIds::Surface>;

    /// Whether they are on screen: else nothing is to be done for them.
    bool wanted = false;

    /// What is seen from now on; returns what the bake is to be asked for. edge: of the lightmap [texels].
    ProbeRequest see(Surfaces surfaces, uint32_t edge);
    void take(LayerProbe probe);
    /// Makes the picture of one light anew where its colour or what it lights is another one. True when it
    /// did: another one may be left.
    bool update(const SceneEdits& edits, const std::vector<LightSource>& sources);
    /// 0: none yet.
    uint32_t texture(const LightKey& key) const;
    void clear(); // another scene

private:
    struct Preview {
        std::vector<glm::vec3> light; // of surfaces_, empty: unknown
        glm::vec3 colour{0.0f};       // it was drawn with
        bool fresh = false;           // it was drawn with `light`
        gl::Texture texture;
    };
    Surfaces surfaces_;
    uint64_t requests_ = 0;
    std::map<LightKey, Preview> previews_;
};

/// RGBA of 8 bits, sRGB encoded, the upper row first.
struct PreviewDesc {
    const LightPreviews::Surfaces& surfaces;
    const std::vector<glm::vec3>& light; // of each surface, lighting for a unit of weight
    const std::vector<Material>& materials;
    LightKey key;
    glm::vec3 colour{1.0f}; // the light's
};
std::vector<uint8_t> previewPixels(const PreviewDesc& desc);

} // namespace relume
