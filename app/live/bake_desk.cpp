#include "app/live/bake_desk.h"

namespace relume {

bool InspectRequest::operator==(const InspectRequest& other) const {
    return content == other.content && mip == other.mip && texel == other.texel &&
           preview.node == other.preview.node && preview.threshold == other.preview.threshold &&
           light == other.light && weight == other.weight;
}

const char* phaseName(BakeStatus::Phase phase) {
    using Phase = BakeStatus::Phase;
    switch (phase) {
    case Phase::Idle:
        return "idle";
    case Phase::Preparing:
        return "preparing";
    case Phase::Baking:
        return "baking";
    case Phase::Paused:
        return "paused";
    case Phase::Done:
        return "done";
    case Phase::Failed:
        return "failed";
    }
    return "";
}

} // namespace relume
