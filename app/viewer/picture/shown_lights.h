#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/viewer/edits/light_edits.h"
#include "app/viewer/picture/scene_view.h"

namespace relume {

/// The lights of the edited scene as its picture has them: which shine, which is selected, and which lights
/// the scene alone.
class ShownLights {
public:
    /// All that it is given must outlive it.
    ShownLights(const Session& session, const BakeStatus& status, SceneView& picture, Feedback& feedback);

    const LightList& list() const { return list_; }
    /// Returns the selected light, or nullptr where none is.
    const LightSource* selected() const;
    void select(const LightKey& key);
    void selectNone() { picture_.state().light.reset(); }
    /// Selects the light that is `step` further on the board.
    void step(int step);
    /// Selects an object of the scene with the light that it is, or lets go of it where it was selected; none
    /// selects nothing.
    void selectObject(const std::optional<Pick>& pick);

    /// Returns the light that alone lights the scene that is shown, or nothing where all of them do.
    std::optional<LightKey> alone() const;
    /// Looks at the scene lit by the selected light alone, or by all again.
    void toggleAlone();

    /// Says that another scene came.
    void sceneCame();
    /// Follows the document. A light that is gone cannot stay selected.
    void follow();

private:
    void showShining();

    const Session& session_;
    const BakeStatus& status_;
    SceneView& picture_;
    Feedback& feedback_;
    LightList list_;
    std::optional<LightKey> shownAlone_; // what alone() was in the last picture
    std::vector<Material> materials_;    // as they are drawn
};

/// Returns how the scene is looked at: "Lit", "Light: Lamp", "Lights: rest" where the light shares a layer.
std::string viewTitle(const ViewState& view, const LightList& lights, const std::vector<LightGroup>& groups);

} // namespace relume
