#include "app/viewer/picture/shots.h"

#include "app/viewer/window/path_completion.h"
#include "renderer/camera_path.h"

#include <utility>

namespace relume {
namespace {

constexpr double kTurnSeconds = 12; // for a turn
constexpr double kLegSeconds = 3;   // from one bookmark to the next

uint32_t framesOf(double seconds) {
    return static_cast<uint32_t>(seconds * Capture::kRate);
}

} // namespace

Shots::Shots(SceneView& picture, Preferences& preferences, Feedback& feedback, Asked asked)
    : picture_(picture), preferences_(preferences), feedback_(feedback), asked_(std::move(asked)) {}

std::string Shots::folder() const {
    return preferences_.captureFolder.empty() ? defaultCaptureFolder()
                                              : expandHome(preferences_.captureFolder);
}

void Shots::perform(Action action) {
    switch (action) {
    case Action::Screenshot:
    case Action::ScreenshotWithUi:
        shot_ = Waiting{.withUi = action == Action::ScreenshotWithUi};
        return;
    case Action::Caption:
        preferences_.caption = !preferences_.caption;
        return;
    case Action::RecordTurn:
        return begin(
            turntable(picture_.camera().camera(), picture_.camera().bounds(), framesOf(kTurnSeconds)));
    case Action::RecordPath:
        if (const std::vector<ViewCamera> marks = stops(); marks.size() > 1)
            return begin(
                cameraPath(marks, framesOf(kLegSeconds * static_cast<double>(marks.size() - 1)) + 1));
        return feedback_.note("a way needs two bookmarks of this scene: store some (Ctrl+B)");
    case Action::RecordAnimation:
        if (std::vector<ViewCamera> cameras = asked_.motion(Capture::kRate); !cameras.empty())
            return begin(std::move(cameras));
        return feedback_.note("the file has no animation that moves a camera");
    default:
        return toggleRecording();
    }
}

std::vector<ViewCamera> Shots::stops() const {
    std::vector<ViewCamera> cameras;
    if (const auto marks = preferences_.bookmarks.find(asked_.path()); marks != preferences_.bookmarks.end())
        for (const Bookmark& mark : marks->second)
            cameras.push_back(mark.camera);
    return cameras;
}

void Shots::begin(std::vector<ViewCamera> cameras) {
    if (asked_.path().empty()) return feedback_.note("there is no scene to record: open one");
    if (recording()) return feedback_.note("a recording is under way: end it before (Ctrl+F12)");
    tour_ = Tour{.cameras = std::move(cameras),
                 .home = picture_.camera().camera(),
                 .exposure = picture_.state().exposure};
    picture_.state().exposure = picture_.pane().exposure();
    capture_.start(folder(), 0.0);
    feedback_.sceneChanged();
}

void Shots::moveCamera() {
    if (!tour_) return;
    picture_.camera().set(tour_->cameras[tour_->next]);
    picture_.cameraMoved();
}

void Shots::sceneCame() {
    if (tour_) endTour(false);
}

void Shots::endTour(bool goHome) {
    if (capture_.recording()) capture_.stop(tour_->time());
    picture_.state().exposure = tour_->exposure;
    if (goHome) {
        picture_.camera().set(tour_->home);
        picture_.cameraMoved();
    }
    tour_.reset();
    recordDue_ = false;
    feedback_.sceneChanged();
}

// Takes the picture of a tour, unless the writer is behind: then the same one is drawn again.
void Shots::takeTourFrame() {
    feedback_.sceneChanged(); // another frame follows
    if (!capture_.wants(tour_->time())) return;
    capture_.frame(captionedPicture(), tour_->time());
    const bool goesOn = capture_.recording(); // a picture of another size ends it
    if (!goesOn || ++tour_->next == tour_->cameras.size()) endTour(true);
}

void Shots::toggleRecording() {
    if (tour_) return endTour(true);
    const double now = feedback_.now();
    if (!capture_.recording()) {
        capture_.start(folder(), now);
        recordDue_ = true;
        return feedback_.sceneChanged(); // the first frame
    }
    if (recordDue_) record(now); // this picture came sooner than a video's next frame
    capture_.stop(now);
}

Pixels Shots::captionedPicture() const {
    const gl::Framebuffer& picture = picture_.pane().picture();
    Pixels pixels = readPixels(picture.get(), picture.width(), picture.height());
    if (preferences_.caption) pixels.caption = asked_.caption();
    return pixels;
}

void Shots::record(double time) {
    capture_.frame(captionedPicture(), time);
    recordDue_ = false;
}

// Tells whether the picture shows what it will show in the end. A screenshot does not wait for ever, because
// new light keeps coming.
bool Shots::settled(Waiting& shot) {
    constexpr int kMostFrames = 10;
    if (!picture_.pane().adapting() || ++shot.frames > kMostFrames) return true;
    feedback_.sceneChanged();
    return false;
}

void Shots::takeFrame(double time, const glm::uvec2& window) {
    if (shot_ && settled(*shot_)) {
        capture_.screenshot(shot_->withUi ? readPixels(0, window.x, window.y) : captionedPicture(), folder());
        shot_.reset();
    }
    if (tour_)
        takeTourFrame();
    else if (recordDue_ && capture_.wants(time))
        record(time);
}

} // namespace relume
