#pragma once

#include <optional>
#include <string>

#include "app/live/session.h"

namespace relume {

/// Decides when the scene on screen may go: at once where nothing would be lost, else after the user was
/// asked, and with "save first" once the save is done. It asks and saves nothing itself.
class Departure {
public:
    /// Names what comes in the scene's place.
    struct Goal {
        std::optional<std::string> scene = {}; // its path; none: the viewer ends
        std::optional<GltfChoice> choice = {}; // of what the present scene's file offers
        bool operator==(const Goal&) const = default;
    };
    enum class Answer { Save, Discard, Cancel };
    enum class Closing { Ends, Asks };

    /// Says what the user wants. Returns it where nothing would be lost; else the question is to be asked.
    [[nodiscard]] std::optional<Goal> want(const Goal& goal, bool unsaved);
    /// Takes the answer to the newest question. Returns the goal where it is reached by it. After Save it
    /// waits for followSave().
    [[nodiscard]] std::optional<Goal> answer(Answer answer);
    /// Follows a save. Returns the goal that waited for it, once; one whose save went wrong is forgotten.
    [[nodiscard]] std::optional<Goal> followSave(bool saving, bool unsaved);
    /// Tells what comes of a window that was closed: by us, or by other means, which is a question all the
    /// same.
    Closing closing(bool unsaved) const { return ends_ || !unsaved ? Closing::Ends : Closing::Asks; }

private:
    std::optional<Goal> reach(const Goal& goal);

    std::optional<Goal> asked_, afterSave_;
    bool ends_ = false; // the viewer may end: edits are saved, or not wanted
};

} // namespace relume
