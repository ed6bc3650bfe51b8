#pragma once

#include <string>

#include "app/live/session.h"
#include "app/viewer/picture/comparison.h"
#include "app/viewer/state/light_progress.h"

namespace relume {

/// Changes the session's document under names that undo shows. Before each change the light is kept for
/// comparison, and the time since the edit begins to count.
class Editing {
public:
    /// All that it is given must outlive it.
    Editing(Session& session, Comparison& comparison, LightProgress& progress, Feedback& feedback);

    /// Sets the document. Calls with the same name one after the other are one edit until end().
    void edit(const std::string& name, const Document& next);
    void end();
    /// Sets the document by an edit of its own.
    void editOnce(const std::string& name, const Document& next);
    /// Takes back the edit that has not ended yet.
    void cancel() { session_.cancelEdit(); }
    void undo();
    void redo();

private:
    void prepare(const std::string& name, bool goesOn);

    Session& session_;
    Comparison& comparison_;
    LightProgress& progress_;
    Feedback& feedback_;
    std::string edited_; // name of the edit under way, "": none
};

} // namespace relume
