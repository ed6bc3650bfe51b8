#pragma once

#include <optional>
#include <string>

#include "app/live/session.h"

namespace relume {

/// The settings of the bake as the controls of a panel show them. They become the document's once they do not
/// contradict each other; until then the document goes its own way, and nothing of it but these settings is
/// ever changed by them.
class BakeDraft {
public:
    BakeSettings bake;
    LightmapDesc lightmap; // of exports

    /// Takes over the document's settings, unless a draft waits or a control is held or typed in. `scene` is
    /// a number that another scene changes, whose settings are taken over in any case.
    void follow(const Document& document, uint64_t scene, bool held);
    /// Says that a control was changed for good. Returns the document with the draft's settings, or nothing
    /// where they contradict each other: the draft then waits, and problem() tells why.
    [[nodiscard]] std::optional<Document> settle(const Document& document);
    bool waits() const { return !problem_.empty(); }
    /// Returns why the draft waits, "" where it does not.
    const std::string& problem() const { return problem_; }
    /// Gives up what waits.
    void drop() { problem_.clear(); }

private:
    std::string problem_;
    uint64_t scene_ = ~uint64_t{0}; // none was followed
};

} // namespace relume
