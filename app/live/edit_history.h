#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/live/document.h"

namespace relume {

/// The steps that undo and redo walk along. It holds documents and applies none of them.
class EditHistory {
public:
    /// Undo keeps so many steps.
    static constexpr size_t kMostSteps = 200;

    /// Adds a step behind the one that is done last, and forgets those that were undone. Edits of the same
    /// name one after the other become one step until end(): those of a dragged slider.
    void add(const std::string& name, const Document& before, const Document& after);
    void end() { open_ = false; }
    /// Takes away the step that end() has not ended yet. Returns what was before it, nothing where there is
    /// none.
    std::optional<Document> cancel();
    /// Return the document that undo or redo leads to, nothing where no step is left.
    std::optional<Document> undo();
    std::optional<Document> redo();
    /// Name the step that undo or redo would take back or make again, "" for none.
    std::string undoName() const;
    std::string redoName() const;
    void forget();

private:
    struct Step {
        std::string name;
        Document before, after;
    };
    std::vector<Step> steps_;
    size_t done_ = 0;   // steps before it are done, the others undone
    bool open_ = false; // the last step may still grow
};

} // namespace relume
