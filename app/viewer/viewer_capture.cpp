#include "app/viewer/viewer.h"

#include "app/progress.h"
#include "app/viewer/path_completion.h"

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
    lines.push_back(fmt::format("{} of solving", formatDuration(status_.progress.seconds)));
    return lines;
}

void Viewer::performCapture(Action action) {
    switch (action) {
    case Action::Screenshot: {
        const gl::Framebuffer& picture = pane_.picture();
        if (picture.get() == 0) return;
        Pixels pixels = readPixels(picture.get(), picture.width(), picture.height());
        pixels.caption = captionLines();
        return capture_.screenshot(std::move(pixels), captureFolder());
    }
    case Action::ScreenshotWithUi:
        shotWithUi_ = true;
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
    if (recordDue_) recordPicture(now()); // came sooner than a video's next frame
    capture_.stop(now());
}

void Viewer::recordPicture(double time) {
    const gl::Framebuffer& picture = pane_.picture();
    Pixels pixels = readPixels(picture.get(), picture.width(), picture.height());
    pixels.caption = captionLines();
    capture_.frame(std::move(pixels), time);
    recordDue_ = false;
}

void Viewer::captureFrame(double time) {
    if (shotWithUi_) {
        shotWithUi_ = false;
        const glm::uvec2 size = window_.size();
        capture_.screenshot(readPixels(0, size.x, size.y), captureFolder());
    }
    if (recordDue_ && capture_.wants(time)) recordPicture(time);
}

} // namespace relume
