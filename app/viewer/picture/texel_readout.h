#pragma once

#include <optional>
#include <string>
#include <utility>

#include "app/viewer/picture/scene_view.h"

namespace relume {

/// Returns what is said of a texel of the map of local errors. `texel` holds the map's channels, `unit` the
/// error of a 1; `any` tells whether the map has an error at all, which a bake has not at its beginning and
/// methods without samples never have.
std::string texelErrorText(const glm::vec4& texel, float unit, bool any);

/// Tells the local error of the texel that was clicked while the picture shows errors, beside its place. It
/// follows the bake, and belongs to the current OpenGL context.
class TexelReadout {
public:
    /// `picture` must outlive it.
    explicit TexelReadout(const SceneView& picture) : picture_(picture) {}

    /// Takes what was clicked, if errors are shown; beside all surfaces, or where these have no lightmap,
    /// nothing is told any more.
    void choose(const std::optional<Pick>& pick);
    /// Says that another scene came.
    void sceneCame() { chosen_.reset(); }
    /// Reads the texel anew where there is a newer map.
    void follow();
    /// Returns what is told now, for the log of actions; "" where that has not changed since the last call.
    std::string takeTold() { return std::exchange(told_, {}); }
    /// Draws it within a frame of Dear ImGui, behind its windows.
    void draw() const;

private:
    bool showsErrors() const;
    std::optional<glm::vec2> place() const;

    const SceneView& picture_;
    std::optional<Pick> chosen_;
    bool flat_ = false;    // it was chosen in the flat lightmap: Pick::position is not known
    uint64_t version_ = 0; // of the map that text_ is of
    std::string text_, told_;
};

} // namespace relume
