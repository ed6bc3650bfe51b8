#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Gives every state of something a number, the same one when it comes back: an undo then finds what was made
/// for it. States are compared word by word. The oldest are forgotten beyond a few tens of megabytes; one
/// that comes back later has a new number.
class StateBook {
public:
    /// Returns the state's number, which is above 0.
    uint64_t numberOf(std::vector<uint32_t> words);

private:
    struct Entry {
        uint64_t number = 0;
        std::vector<uint32_t> words;
    };
    std::deque<Entry> entries_; // the newest last
    uint64_t last_ = 0, bytes_ = 0;
};

/// The numbers of what all layers depend on: base colours of materials, and where objects stand.
struct SceneState {
    uint64_t surfaces = 0, objects = 0;

    bool operator==(const SceneState&) const = default;
};

/// Knows the states that a scene went through.
class SceneStates {
public:
    /// Takes note of the state that the scene is in.
    void note(const Scene& scene);
    /// Says that surfaces look otherwise from now on for the same base colours: no former state comes back.
    void repainted() { ++paint_; }
    const SceneState& now() const { return now_; }
    const SceneState& before() const { return before_; } // before the newest note()

private:
    StateBook surfaces_, objects_;
    uint32_t paint_ = 0;
    SceneState now_, before_;
};

} // namespace relume
