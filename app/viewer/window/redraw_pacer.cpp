#include "app/viewer/window/redraw_pacer.h"

#include <algorithm>

namespace relume {
namespace {

// Panels of ImGui react to what they find under the cursor one frame after it came there, and may change
// their size for one more.
constexpr int kSettlingFrames = 3;
constexpr double kStatusPeriod = 0.1; // [s]: figures are not read faster
// Drawing takes a third of the time while nobody moves anything: it waits this many times what it cost.
constexpr double kRest = 2.0;

} // namespace

void RedrawPacer::input() {
    settling_ = kSettlingFrames;
}

// Returns from when on a map or figures may be drawn.
double RedrawPacer::nextPaced() const {
    const double cost = map_ ? std::max(lastCost_, sceneCost_) : lastCost_;
    const double rest = lastEnd_ + kRest * cost;
    return map_ ? rest : std::max(rest, lastEnd_ + kStatusPeriod);
}

Redraw RedrawPacer::due(double now) const {
    const bool paced = (map_ || status_) && now >= nextPaced();
    Redraw redraw;
    redraw.scene = scene_ || (map_ && (paced || animated_));
    redraw.any = redraw.scene || animated_ || settling_ > 0 || paced;
    return redraw;
}

double RedrawPacer::wait(double now, double idle) const {
    if (due(now).any) return 0;
    return map_ || status_ ? std::clamp(nextPaced() - now, 0.0, idle) : idle;
}

void RedrawPacer::drawn(const Redraw& what, double end, double cost) {
    settling_ = std::max(settling_ - 1, 0);
    status_ = smallPicture_ = false;
    lastEnd_ = end;
    lastCost_ = cost;
    if (!what.scene) return;
    scene_ = map_ = false;
    sceneCost_ = cost;
}

} // namespace relume
