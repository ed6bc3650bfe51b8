#pragma once

#include <map>
#include <optional>
#include <vector>

#include "app/live/live_bake.h"
#include "renderer/gl/texture.h"
#include "renderer/surface_ids.h"

namespace relume {

/// Makes a small picture of what each light lights, with all bounces, from where the camera rested last. Each
/// is exposed by itself: a weak light's shows as much as a strong one's. The pictures belong to the current
/// OpenGL context.
class LightPreviews {
public:
    using Surfaces = std::vector<SurfaceIds::Surface>;

    /// They are on screen: otherwise nothing is to be done for them.
    bool wanted = false;

    /// Sets the surfaces that are seen from now on. Returns what the bake is to be asked for. `edge` is the
    /// lightmap's [texels].
    ProbeRequest see(Surfaces surfaces, uint32_t edge);
    void take(LayerProbe probe);
    /// Makes the picture of one light anew where its colour or its layer has changed. Returns whether it did:
    /// another one may be left.
    bool update(const SceneEdits& edits, const std::vector<LightSource>& sources);
    /// Returns the texture of a light's picture; 0: there is none yet.
    uint32_t texture(const LightKey& key) const;
    void clear(); // another scene

private:
    struct Preview {
        std::vector<glm::vec3> light; // at surfaces_, empty: unknown
        glm::vec3 colour{0.0f};       // it was drawn with
        bool fresh = false;           // it was drawn with `light`
        gl::Texture texture;
    };
    Surfaces surfaces_;
    uint64_t requests_ = 0;
    std::map<LightKey, Preview> previews_;
};

/// The data that a preview is made of. Its pixels are RGBA of 8 bits, sRGB encoded, the upper row first.
struct PreviewDesc {
    const LightPreviews::Surfaces& surfaces;
    const std::vector<glm::vec3>& light; // of each surface, lighting for a unit of weight
    const std::vector<Material>& materials;
    LightKey key;
    glm::vec3 colour{1.0f}; // the light's
};
std::vector<uint8_t> previewPixels(const PreviewDesc& desc);

} // namespace relume
