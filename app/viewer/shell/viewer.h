#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/live/session.h"
#include "app/viewer/edits/light_edits.h"
#include "app/viewer/picture/capture.h"
#include "app/viewer/picture/light_overlay.h"
#include "app/viewer/picture/light_previews.h"
#include "app/viewer/picture/lightmap_bridge.h"
#include "app/viewer/picture/scene_pane.h"
#include "app/viewer/picture/sky_pictures.h"
#include "app/viewer/shell/ui.h"
#include "app/viewer/state/bake_badge.h"
#include "app/viewer/state/camera_control.h"
#include "app/viewer/window/gui.h"
#include "app/viewer/window/redraw_pacer.h"
#include "app/viewer/window/window.h"

namespace relume {

struct ViewerDesc {
    std::string scene; // "": none yet
    BakeRequest request;
    std::string device; // the same as vk::Device::Desc::select
    bool validation = false;
    DisplayMode display = DisplayMode::Auto;
    double budgetMs = 8; // how long a batch should take while the camera is still
    bool watch = false;
    uint32_t width = 0, height = 0; // of the window [screen coordinates], 0: as last time
    std::string camera;             // of the scene's, "": its first one
    bool logActions = false;        // on stderr, each when it is done
};

/// The window with the scene in it, lit by a bake that goes on beside it. It belongs to the main thread.
class Viewer {
public:
    explicit Viewer(const ViewerDesc& desc); // shows the window; throws Error when there can be none
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    /// Runs until the window is closed. Throws Error when drawing fails for good.
    void run();

private:
    // These are in viewer.cpp.
    void startBake();
    void savePreferences();
    double now() const;
    double idleSeconds(double time) const;
    void follow(double time);
    void followScene();
    void followBake(double time);
    void followCamera(double time);
    void followLog();
    void inspect();
    void followInspected();
    void followMap();
    void tellSettled();
    ScenePane::Look look() const;
    PanelContext context();
    void frame(const Redraw& redraw);
    void drawScene(bool anew);
    LightmapTexture lightmap() const;
    const PublishedMap* map() const;
    void showMaterials(std::vector<Material> materials);
    void changeScene() { sceneDirty_ = settling_ = true; }
    float pixelsPerPoint() const;

    // These are in viewer_input.cpp.
    void handle(const std::vector<WindowEvent>& events);
    void onKey(const WindowEvent& event);
    void onButton(const WindowEvent& event);
    void onCursor(const WindowEvent& event);
    void onScroll(const WindowEvent& event);
    void onClick(const WindowEvent& event);
    bool overScene(const glm::dvec2& at) const;
    void updateFlight();
    void cameraMoved();

    // These are in viewer_files.cpp.
    std::string scenePath() const; // absolute, the key of bookmarks; "" without a scene
    void performFile(Action action);
    void open(const std::string& path);
    void exportLightmap(const std::string& path);
    void save(const std::string& path);
    void unlessUnsaved(const std::string& what, const std::function<void()>& go);
    void quit();
    bool closes();
    void followFile();
    void followSavedPath();

    // These are in viewer_progress.cpp.
    void followBadge(double time);
    void beforeEdit(const std::string& name, const std::string& underWay);
    void performWipe(Action action);
    bool showsWipe() const;
    bool overWipe(const glm::dvec2& at) const;
    void dragWipe(const glm::dvec2& at);
    void drawProgress();

    // These are in viewer_lights.cpp.
    void selectLight(const std::optional<LightKey>& key);
    void followLights();
    LightSpot lightSpot();
    void addLight(int what);
    void stepLight(int step);
    void editOnce(const std::string& name, const Document& next);
    void endEdit();
    void performLight(Action action, int argument);

    // These are in viewer_layers.cpp.
    std::optional<LightKey> loneLight() const;
    void toggleAlone();
    void showShining();
    void followPreviews(double time);
    void chooseSky();
    void clearSky();
    void followSky();
    void takeSky(const SkyPictures::Result& result);

    // These are in viewer_gizmo.cpp.
    LightStage stage() const;
    glm::vec2 pointAt(const glm::dvec2& at) const;
    bool showsLights() const;
    std::optional<uint32_t> movableObject() const;
    glm::mat4* movable(Document& document) const;
    std::string movableName() const;
    void nudge(int argument);
    void performObject(Action action);
    bool pressGizmo(const glm::dvec2& at);
    std::optional<glm::mat4> onSurface(const glm::dvec2& at);
    void dragGizmo(const glm::dvec2& at);
    void endDrag();
    void onDragKey(const WindowEvent& event);
    void tellPlaces();
    void drawOverlay();

    // These are in viewer_actions.cpp.
    void perform(Action action, int argument);
    void performUndo(Action action);
    void performBake(Action action);
    void performView(Action action, int argument);
    void performCamera(Action action);
    void performCapture(Action action);
    void reloadShaders();
    void storeBookmark();
    void captureFrame(double time);
    void recordPicture(double time);
    Pixels captionedPicture() const;
    bool settled();
    std::string captureFolder() const;
    void note(const std::string& text, bool bad = false);
    void tell(const char* kind, const std::string& what) const; // a line for --log-actions
    void edit(const std::string& name, const Document& next);
    std::vector<std::string> captionLines() const;

    ViewerDesc desc_;
    Clock::time_point start_;
    std::string preferencesPath_;
    Preferences preferences_;
    LogBuffer log_;
    std::unique_ptr<LiveBake> bake_; // outlives OpenGL (live_bake.h)
    Window window_;
    Gui gui_;
    bool software_; // OpenGL is drawn by the CPU
    ScenePane pane_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<LightmapBridge> bridge_;
    Capture capture_;
    Ui ui_;
    ui::ItemLog items_;

    ViewState view_;
    CameraControl camera_;
    uint64_t saves_ = 0;              // how many saves were told
    std::string title_, path_;        // of the window, and of the scene when it was loaded or saved
    std::function<void()> afterSave_; // waits for the save under way
    bool quitting_ = false;           // edits are saved, or not wanted
    LightList lights_;
    std::optional<LightKey> shownAlone_; // what loneLight() was in the last picture
    LightPreviews previews_;
    struct Previewed { // what the previews show
        ViewCamera camera;
        uint64_t scene = 0; // its number
        std::vector<Placement> placements;
        uint32_t size = 0; // of the lightmap

        bool operator==(const Previewed&) const = default;
    };
    std::optional<Previewed> previewed_; // none: nothing is asked for
    bool previewsDue_ = false;           // some may still have to be drawn
    SkyPictures skies_;
    std::string badSky_; // the document's picture of the sky, where it could not be read
    std::optional<GizmoDrag> drag_;
    BakeBadge badge_;
    std::string newestEdit_; // its name, "": none since the scene came
    double editedAt_ = 0, convergedAt_ = 0;
    bool ownReference_ = false; // B is what the user stored, and stays
    bool wipeDrag_ = false;
    FrameFigures figures_;
    RedrawPacer pacer_;
    BakeStatus status_;
    InspectRequest inspected_;
    std::vector<Material> materials_; // as they are drawn
    Ui::Area area_;                   // of the scene, in the last frame
    bool sceneDirty_ = true, hidden_ = false, vsync_ = false;
    float scale_ = 1;
    enum class Shot { None, Plain, WithUi };
    Shot shot_ = Shot::None; // the one that waits for a settled picture
    int shotFrames_ = 0;     // how many frames it has waited
    bool settling_ = false;  // the exposure follows what the user did
    bool recordDue_ = false; // the picture is not in the recording
    double frameStart_ = 0;  // of the last frame
    double flown_ = 0;       // when the flight went on last
    double moved_ = -1e9;    // when the camera moved last
    double batchMs_ = 0;     // what the bake was told
    uint64_t logSeen_ = 0;
    std::string edited_;    // name of the edit under way, "": none
    struct Told {           // for --log-actions, the last of each
        std::string map;    // content of the newest map
        glm::uvec2 size{0}; // of the window
        bool minimised = false;
        bool settled = false;   // what was asked for is on the screen
        uint64_t converged = 0; // the bake whose light had converged, 0: none
        uint64_t inputs = 0;    // taken so far
    };
    Told told_;
    uint32_t askedVoxels_ = 0;
    uint64_t askedBake_ = 0; // the bake that was asked for voxels and tiles
    double tilesAsked_ = -1e9;
    uint64_t mapVersion_ = 0;
    glm::dvec2 cursor_{0.0}, pressed_{0.0};
    int button_ = 0;                      // the mouse button that drags
    bool dragged_ = false;                // it went further than a click does
    std::vector<int> keys_;               // the keys of flight that are held
    bool fast_ = false, control_ = false; // Shift, Ctrl are held
};

} // namespace relume
