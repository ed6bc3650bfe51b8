#include "app/viewer/state/departure.h"

#include <utility>

namespace relume {

std::optional<Departure::Goal> Departure::reach(const Goal& goal) {
    if (!goal.scene) ends_ = true;
    return goal;
}

std::optional<Departure::Goal> Departure::want(const Goal& goal, bool unsaved) {
    if (!unsaved) return reach(goal);
    asked_ = goal;
    return std::nullopt;
}

std::optional<Departure::Goal> Departure::answer(Answer answer) {
    const std::optional<Goal> goal = std::exchange(asked_, std::nullopt);
    if (!goal || answer == Answer::Cancel) return std::nullopt;
    if (answer == Answer::Discard) return reach(*goal);
    afterSave_ = goal;
    return std::nullopt;
}

std::optional<Departure::Goal> Departure::followSave(bool saving, bool unsaved) {
    if (!afterSave_ || saving) return std::nullopt;
    const Goal goal = *std::exchange(afterSave_, std::nullopt);
    if (unsaved) return std::nullopt;
    return reach(goal);
}

} // namespace relume
