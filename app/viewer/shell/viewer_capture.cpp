#include "app/viewer/shell/viewer.h"

#include "app/offline/progress.h"
#include "app/viewer/window/path_completion.h"

#include <fmt/format.h>

namespace relume {

std::string Viewer::captureFolder() const {
    return preferences_.captureFolder.empty() ? defaultCaptureFolder()
                                              : expandHome(preferences_.captureFolder);
}

std::vector<std::string> Viewer::captionLines() const {
    if (!preferences_.caption) return {};
    const std::string path = scenePath();
    std::vector<std::string> lines = {path.substr(path.find_last_of('/') + 1), statusLine(status_)};
    if (loneLight()) lines.push_back(viewTitle(view_, lights_, status_.groups));
    lines.push_back(fmt::format("{} of solving", formatDuration(status_.progress.seconds)));
    return lines;
}

void Viewer::performCapture(Action action) {
    switch (action) {
    case Action::Screenshot:
    case Action::ScreenshotWithUi:
        shot_ = action == Action::Screenshot ? Shot::Plain : Shot::WithUi;
        shotFrames_ = 0;
        return;
    case Action::Caption:
        preferences_.caption = !preferences_.caption;
        return;
    default:
        break;
    }
    if (!capture_.recording()) {
        capture_.start(captureFolder(), now());
        recordDue_ = true;
        return changeScene(); // the first frame
    }
    if (recordDue_) recordPicture(now()); // this picture came sooner than a video's next frame
    capture_.stop(now());
}

Pixels Viewer::captionedPicture() const {
    const gl::Framebuffer& picture = pane_.picture();
    Pixels pixels = readPixels(picture.get(), picture.width(), picture.height());
    pixels.caption = captionLines();
    return pixels;
}

void Viewer::recordPicture(double time) {
    capture_.frame(captionedPicture(), time);
    recordDue_ = false;
}

// Tells whether the waiting screenshot shows what it will show in the end. It does not wait for ever, because
// new light keeps coming.
bool Viewer::settled() {
    constexpr int kMostFrames = 10;
    if (!pane_.adapting() || ++shotFrames_ > kMostFrames) return true;
    changeScene();
    return false;
}

void Viewer::captureFrame(double time) {
    if (shot_ != Shot::None && settled()) {
        const glm::uvec2 size = window_.size();
        capture_.screenshot(shot_ == Shot::Plain ? captionedPicture() : readPixels(0, size.x, size.y),
                            captureFolder());
        shot_ = Shot::None;
    }
    if (recordDue_ && capture_.wants(time)) recordPicture(time);
}

} // namespace relume
