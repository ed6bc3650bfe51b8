#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/viewer/picture/capture.h"
#include "app/viewer/picture/scene_view.h"
#include "app/viewer/state/preferences.h"
#include "app/viewer/state/shortcuts.h"

namespace relume {

/// Takes screenshots and recordings when they are due: a screenshot once the picture has settled, a recording
/// whenever there is another picture.
class Shots {
public:
    /// Returns the lines that are written into a picture.
    using Caption = std::function<std::vector<std::string>()>;
    /// The first three must outlive it.
    Shots(SceneView& picture, Preferences& preferences, Feedback& feedback, Caption caption);

    /// Does an action from Screenshot to Caption.
    void perform(Action action);
    bool recording() const { return capture_.recording(); }
    /// Says that there is another picture of the scene.
    void pictureDrawn() { recordDue_ = true; }
    /// Takes what is due, once the frame is drawn that is shown from `time` [s] on, and before it is shown.
    void takeFrame(double time, const glm::uvec2& window);

private:
    /// A screenshot that waits for a settled picture.
    struct Waiting {
        bool withUi = false;
        int frames = 0; // that it has waited
    };
    bool settled(Waiting& shot);
    void toggleRecording();
    void record(double time);
    Pixels captionedPicture() const;
    std::string folder() const;

    SceneView& picture_;
    Preferences& preferences_;
    Feedback& feedback_;
    Caption caption_;
    Capture capture_;
    std::optional<Waiting> shot_;
    bool recordDue_ = false; // the picture is not in the recording
};

} // namespace relume
