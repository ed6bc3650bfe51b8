#pragma once

#include <cstdint>
#include <optional>

namespace relume {

/// Decides when a scene that was opened takes the place of the one before: as soon as it was read, unless the
/// user has made edits since it was asked for that are not saved. These are not lost without a question.
class Arrival {
public:
    enum class Step { Waits, Comes, IsRefused };

    /// Says that a scene is asked for. `changes` numbers the document, see Session::changes().
    void ask(uint64_t changes);
    /// Decides about the scene, which was read. `unsaved` says that the document has edits that its file
    /// lacks.
    [[nodiscard]] Step decide(uint64_t changes, bool unsaved);
    /// Tells whether the scene waits for an answer.
    bool waits() const { return waits_; }
    /// Takes the user's answer: the scene comes and the edits are lost, or it does not come at all.
    void answer(bool comes);

private:
    uint64_t asked_ = 0; // the document's number when the scene was asked for
    std::optional<bool> answer_;
    bool waits_ = false;
};

} // namespace relume
