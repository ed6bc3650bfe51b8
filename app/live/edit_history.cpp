#include "app/live/edit_history.h"

#include <utility>

namespace relume {

void EditHistory::add(const std::string& name, const Document& before, const Document& after) {
    if (open_ && done_ == steps_.size() && done_ > 0 && steps_.back().name == name) {
        steps_.back().after = after;
    } else {
        steps_.resize(done_);
        if (steps_.size() >= kMostSteps) steps_.erase(steps_.begin());
        steps_.push_back({name, before, after});
        done_ = steps_.size();
    }
    open_ = true;
}

std::optional<Document> EditHistory::cancel() {
    if (!open_ || done_ == 0 || done_ != steps_.size()) return std::nullopt;
    Document before = std::move(steps_.back().before);
    steps_.pop_back();
    done_ = steps_.size();
    open_ = false;
    return before;
}

std::optional<Document> EditHistory::undo() {
    open_ = false;
    if (done_ == 0) return std::nullopt;
    return steps_[--done_].before;
}

std::optional<Document> EditHistory::redo() {
    open_ = false;
    if (done_ == steps_.size()) return std::nullopt;
    return steps_[done_++].after;
}

std::string EditHistory::undoName() const {
    return done_ > 0 ? steps_[done_ - 1].name : "";
}

std::string EditHistory::redoName() const {
    return done_ < steps_.size() ? steps_[done_].name : "";
}

void EditHistory::forget() {
    steps_.clear();
    done_ = 0;
    open_ = false;
}

} // namespace relume
