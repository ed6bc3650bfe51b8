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
/// whenever there is another picture. A tour is a recording for which the camera moves by itself, picture by
/// picture, as fast as they are written.
class Shots {
public:
    /// Returns the lines that are written into a picture.
    using Caption = std::function<std::vector<std::string>()>;
    /// Says what is asked of the scene.
    struct Asked {
        Caption caption;
        std::function<std::string()> path; // by which bookmarks are kept; "" without a scene
        /// Returns where the file's animation takes a camera, so many times per second; empty: it moves none.
        std::function<std::vector<ViewCamera>(double)> motion;
    };
    /// The first three must outlive it.
    Shots(SceneView& picture, Preferences& preferences, Feedback& feedback, Asked asked);

    /// Does an action from Screenshot to Caption.
    void perform(Action action);
    bool recording() const { return capture_.recording(); }
    /// Moves the camera on its tour, before the frame is drawn.
    void moveCamera();
    /// Ends a tour where it is, as there is another scene.
    void sceneCame();
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
    /// A camera that moves by itself.
    struct Tour {
        std::vector<ViewCamera> cameras;
        size_t next = 0;
        ViewCamera home;                    // where it was
        std::optional<float> exposure = {}; // as it was set; all pictures have that of the first
        double time() const { return (static_cast<double>(next) + 0.5) / Capture::kRate; } // of a video
    };
    bool settled(Waiting& shot);
    void toggleRecording();
    std::vector<ViewCamera> stops() const;
    void begin(std::vector<ViewCamera> cameras);
    void takeTourFrame();
    void endTour(bool goHome);
    void record(double time);
    Pixels captionedPicture() const;
    std::string folder() const;

    SceneView& picture_;
    Preferences& preferences_;
    Feedback& feedback_;
    Asked asked_;
    Capture capture_;
    std::optional<Tour> tour_;
    std::optional<Waiting> shot_;
    bool recordDue_ = false; // the picture is not in the recording
};

} // namespace relume
