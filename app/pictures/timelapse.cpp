#include "app/pictures/timelapse.h"

#include "app/text/interrupt.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "renderer/caption.h"

#include <cmath>

namespace relume {
namespace {

// At most so many bytes of lightmaps wait in memory: a hundred of 1024 x 1024. With more, the series gets the
// exposure of what it shows by then, which hardly differs from its end's.
constexpr uint64_t kMostWaiting = uint64_t{2} << 30;

uint64_t bytesOf(const FloatImage& image) {
    return uint64_t{image.planes.size()} * image.width * image.height * sizeof(float);
}

} // namespace

Timelapse::Timelapse(const Desc& desc)
    : desc_(desc), draw_(desc.request.shot.draw), nextSeconds_(desc.request.every) {}

uint32_t Timelapse::countNow() const {
    const SolverProgress& progress = desc_.baker.solver().progress();
    return desc_.pairs ? progress.passes : progress.samples;
}

// Returns how many frames show what there is now.
uint32_t Timelapse::framesDue() {
    const uint32_t count = countNow();
    if (desc_.request.every > 0) {
        const double behind = desc_.baker.solver().progress().seconds - nextSeconds_;
        if (behind < 0) return 0;
        const double frames = std::floor(behind / desc_.request.every) + 1;
        nextSeconds_ += frames * desc_.request.every;
        // Nothing is known before the first bounce or sample pass: the series starts with the first light.
        if (count == 0) return 0;
        const bool first =
            moments_.size() == 1 && moments_.back().frames.empty() && desc_.writer.count() == 0;
        return first ? 1 : static_cast<uint32_t>(frames);
    }
    if (count == 0) return 0;
    if (desc_.request.at.empty()) {
        if (count < nextCount_) return 0;
        nextCount_ = 2 * count;
        return 1;
    }
    const size_t before = nextAt_;
    while (nextAt_ < desc_.request.at.size() && desc_.request.at[nextAt_] <= count)
        ++nextAt_;
    if (nextAt_ > before + 1)
        spdlog::info("one frame for --at {} to {}: {} directions per patch come at once",
                     desc_.request.at[before], desc_.request.at[nextAt_ - 1], count);
    return nextAt_ > before ? 1 : 0;
}

void Timelapse::afterStep(Solver&) {
    // By time, a frame may be due within a sample pass, when light cannot be told: it is kept when one ends.
    const bool fresh = moments_.empty() ? countNow() > 0 : moments_.back().count != countNow();
    if (desc_.request.every > 0 && fresh) keepLight();
    const uint32_t frames = framesDue();
    if (frames == 0) return;
    add(frames);
    uint64_t waiting = 0;
    for (const Moment& moment : moments_)
        waiting += bytesOf(moment.lightmap);
    // The newest moment waits: it may turn out to be the bake's end, which is another frame.
    if (draw_.exposure || waiting > kMostWaiting) flush(1);
}

void Timelapse::add(uint32_t times) {
    if (desc_.request.every == 0 || desc_.baker.solver().done()) keepLight();
    moments_.back().frames.push_back({times, caption()});
}

void Timelapse::keepLight() {
    if (!moments_.empty() && moments_.back().frames.empty()) moments_.pop_back(); // no frame ever showed it
    moments_.push_back({countNow(), desc_.baker.lightmap(desc_.lightmap), {}});
}

std::vector<std::string> Timelapse::caption() const {
    if (!desc_.request.caption) return {};
    const SolverProgress& progress = desc_.baker.solver().progress();
    std::string text = desc_.pairs
                           ? fmt::format("{} pass{}", progress.passes, progress.passes > 1 ? "es" : "")
                           : fmt::format("{} directions per patch", progress.samples);
    if (progress.error < 1.0) text += fmt::format(", error {:.2g}", progress.error);
    return {desc_.title, text + fmt::format(", {:.2f} s", progress.seconds)};
}

// Writes all but the `kept` newest moments. Where no exposure was given, the newest one's is measured.
void Timelapse::flush(size_t kept) {
    if (moments_.empty()) return;
    if (!draw_.exposure) {
        const LightmapImage newest(moments_.back().lightmap, "lightmap");
        desc_.studio.take(newest.texture(), draw_);
        draw_.exposure = desc_.studio.exposure();
    }
    const size_t count = moments_.size() - std::min(kept, moments_.size());
    for (size_t i = 0; i < count; ++i)
        write(moments_[i]);
    moments_.erase(moments_.begin(), moments_.begin() + static_cast<std::ptrdiff_t>(count));
}

void Timelapse::write(const Moment& moment) {
    const LightmapImage lightmap(moment.lightmap, "lightmap");
    const FloatImage bare = desc_.studio.take(lightmap.texture(), draw_);
    for (const Frame& frame : moment.frames) {
        FloatImage picture = bare;
        drawCaption(picture, frame.caption);
        desc_.writer.write(picture, frame.times);
    }
}

void Timelapse::interrupt(Solver&) {
    if (desc_.writer.keepsFrames()) flush(0);
    const uint32_t count = desc_.writer.keepsFrames() ? desc_.writer.count() : 0;
    throw Error(count == 0 ? std::string("interrupted: nothing was written")
                           : fmt::format("interrupted: {} frames were written", count));
}

void Timelapse::finish() {
    // By count, the last moment may have the same count as the end: the end replaces it.
    const bool again = desc_.request.every == 0 && !moments_.empty() && moments_.back().count == countNow();
    if (again) moments_.pop_back();
    add(1);
    flush(0);
    desc_.writer.finish();
    spdlog::info("exposure {:.2f} EV", *draw_.exposure);
}

} // namespace relume
