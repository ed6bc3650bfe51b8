#pragma once

#include "app/viewer/picture/scene_view.h"
#include "app/viewer/state/shortcuts.h"

namespace relume {

/// Compares the light of now (A) with other light (B), on both sides of a line that one can drag. B is the
/// last light that had converged before an edit, or what the user stored.
class Comparison {
public:
    /// Both arguments must outlive it.
    Comparison(SceneView& picture, Feedback& feedback) : picture_(picture), feedback_(feedback) {}

    /// Says that another scene came: what the user stored of the former one is no reference any more.
    void sceneCame() { stored_ = false; }
    /// Keeps the light for comparison before it is edited, where it had converged.
    void beforeEdit(bool converged);
    /// Does Wipe or StoreReference.
    void perform(Action action);
    /// Tells whether the picture has the line in it.
    bool shown() const;

    /// Follow the mouse. press() returns whether it takes hold of the line, which it does until release().
    bool press(const glm::dvec2& at);
    bool held() const { return held_; }
    void drag(const glm::dvec2& at);
    void release() { held_ = false; }

    /// Returns the middle of the line in the window.
    glm::vec2 grip() const;
    /// Draws the line and what lies on its sides, within a frame of Dear ImGui and behind its windows.
    void draw() const;

private:
    SceneView& picture_;
    Feedback& feedback_;
    bool stored_ = false; // B is what the user stored, and stays
    bool held_ = false;
};

} // namespace relume
