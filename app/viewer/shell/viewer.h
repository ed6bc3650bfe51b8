#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/live/session.h"
#include "app/viewer/picture/comparison.h"
#include "app/viewer/picture/inspection.h"
#include "app/viewer/picture/preview_updates.h"
#include "app/viewer/picture/scene_view.h"
#include "app/viewer/picture/shots.h"
#include "app/viewer/picture/shown_lights.h"
#include "app/viewer/shell/bake_control.h"
#include "app/viewer/shell/editing.h"
#include "app/viewer/shell/light_keys.h"
#include "app/viewer/shell/mover.h"
#include "app/viewer/shell/scene_files.h"
#include "app/viewer/shell/sky_keys.h"
#include "app/viewer/shell/ui.h"
#include "app/viewer/state/held_input.h"
#include "app/viewer/state/kept_preferences.h"
#include "app/viewer/state/light_progress.h"
#include "app/viewer/state/screen_log.h"
#include "app/viewer/window/gui.h"
#include "app/viewer/window/window.h"

namespace relume {

struct ViewerDesc {
    std::string scene; // "": none yet
    BakeRequest request;
    std::string device;        // the same as LiveBake::Desc::device
    uint64_t deviceMemory = 0; // likewise
    bool validation = false;
    DisplayMode display = DisplayMode::Auto;
    double budgetMs = 8;            // how long a batch should take while the camera is still
    bool watch = true;              // the scene is read again when its file changes
    uint32_t width = 0, height = 0; // of the window [screen coordinates], 0: as last time
    std::string camera;             // of the scene's, "": its first one
    bool logActions = false;        // on stderr, each when it is done
};

/// The window with the scene in it, lit by a bake that goes on beside it. Here is the loop: what happened
/// goes to whom it concerns, all follow the session and the bake, and a frame is drawn when one is due. It
/// belongs to the main thread.
class Viewer {
public:
    explicit Viewer(const ViewerDesc& desc); // shows the window; throws NoWindow when there can be none
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    /// Runs until the window is closed. Throws Error when drawing fails for good.
    void run();

private:
    // These are in viewer.cpp.
    LiveBake& startBake();
    void savePreferences();
    double idleSeconds(double time) const;
    void follow(double time);
    void followScene();
    void takeScene();
    ViewCamera firstCamera(const LoadedScene& scene);
    void followBake(double time);
    bool settled() const;
    void followMiddle();
    Opening::Facts openingFacts() const;
    std::optional<PictureNotice> notice() const;
    MiddleView middleView();
    PanelContext context();
    void frame(const Redraw& redraw);
    std::string furnishedLine() const;
    void drawOverlay();
    std::vector<std::string> captionLines() const;
    std::vector<ViewCamera> cameraMotion(double rate) const;
    float pixelsPerPoint() const;

    // These are in viewer_input.cpp.
    void handle(const std::vector<WindowEvent>& events);
    void onKey(const WindowEvent& event);
    void onButton(const WindowEvent& event);
    void onCursor(const WindowEvent& event);
    void onScroll(const WindowEvent& event);
    void onClick(const WindowEvent& event);
    bool overScene(const glm::dvec2& at) const;
    void perform(Action action, int argument);
    void act(Action action, int argument);
    void performView(Action action, int argument);
    void performCamera(Action action);
    void storeBookmark();
    void reloadShaders();

    ViewerDesc desc_;
    Feedback feedback_;
    KeptPreferences preferences_;
    LogBuffer log_;
    std::unique_ptr<LiveBake> bake_; // outlives OpenGL (live_bake.h)
    Window window_;
    Gui gui_;
    Session session_;
    SceneView picture_;
    BakeControl baking_;
    ShownLights lights_;
    LightProgress progress_;
    Comparison comparison_;
    Editing editing_;
    Inspection inspection_;
    PreviewUpdates previews_;
    Shots shots_;
    Ui ui_;
    LightKeys lightKeys_;
    SkyKeys skyKeys_;
    Mover mover_;
    SceneFiles files_;
    HeldInput input_;
    ScreenLog screenLog_;
    FrameFigures figures_;
};

} // namespace relume
