#include "app/viewer/picture/shots.h"

#include "app/viewer/window/path_completion.h"

#include <utility>

namespace relume {

Shots::Shots(SceneView& picture, Preferences& preferences, Feedback& feedback, Caption caption)
    : picture_(picture), preferences_(preferences), feedback_(feedback), caption_(std::move(caption)) {}

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
    default:
        return toggleRecording();
    }
}

void Shots::toggleRecording() {
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
    if (preferences_.caption) pixels.caption = caption_();
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
    if (recordDue_ && capture_.wants(time)) record(time);
}

} // namespace relume
