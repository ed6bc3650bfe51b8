#include "app/viewer/state/screen_log.h"

#include "app/viewer/state/views.h"

#include <fmt/format.h>

namespace relume {
namespace {

const char* contentName(MapContent content) {
    for (const ViewEntry& entry : viewEntries())
        if (entry.readsMap && entry.content == content && content != MapContent::Light) return entry.name;
    return "light";
}

} // namespace

void ScreenLog::tellWindow(const glm::uvec2& size, bool minimised) {
    if (minimised != minimised_) {
        minimised_ = minimised;
        feedback_.tell("window", minimised ? "minimised" : "shown");
    }
    if (size != size_ && !minimised) {
        size_ = size;
        feedback_.tell("window", fmt::format("{} x {}", size.x, size.y));
    }
}

void ScreenLog::tellMap(const PublishedMap& map) {
    const std::string told =
        std::string(contentName(map.content)) + (map.complete ? " complete" : " partial");
    if (told != map_) feedback_.tell("map", told);
    map_ = told;
}

bool ScreenLog::tellMiddle(const std::string& name) {
    if (name == middle_) return false;
    middle_ = name;
    feedback_.tell("middle", name);
    return true;
}

void ScreenLog::countInputs(size_t count) {
    inputs_ += count;
    settled_ = settled_ && count == 0;
}

void ScreenLog::tellSettled(bool settled) {
    if (settled && !settled_) feedback_.tell("settled", std::to_string(inputs_));
    settled_ = settled;
}

} // namespace relume
