#pragma once

#include <optional>
#include <string>

#include "app/live/session.h"

namespace relume {

/// Says what stands in the middle of the window.
struct Middle {
    /// A card lies over what else is there.
    enum class Card {
        None,
        Opening, // a file is being read of which nothing is shown yet
        Failure, // a file could not be opened
        Notice,  // why the picture shows nothing, or no light
    };
    bool startPage = false; // it fills the window in place of panels and picture
    Card card = Card::None;
    bool operator==(const Middle&) const = default;
};
/// Returns "scene", "start page", "failure over start page": what `--log-actions` tells.
std::string middleName(const Middle& middle);

/// Returns what a load does in words: "Reading the file" for the phase "loading".
std::string loadingWords(const std::string& phase);

/// Follows what the user opens. It decides what stands in the middle of the window until there is a scene,
/// and where there is none. It knows no clock: all times [s] are the caller's.
class Opening {
public:
    /// Where a scene is shown already, a file that is read faster than this [s] shows no card: it would only
    /// flash.
    static constexpr double kPatience = 0.25;

    struct Facts {
        bool scene = false;      // one is shown
        bool loading = false;    // a file is being read
        double time = 0;         // now
        std::string notice = {}; // why the picture shows nothing, "": nothing to be said
    };

    /// Says that the user opens a file: whatever was in the middle goes.
    void begin(const std::string& path, double time);
    void fail(OpenFailure failure);
    /// Says that another scene came.
    void sceneCame();
    /// Says that the file is not opened after all.
    void giveUp() { path_.clear(); }
    /// Says that the user wants the start page, over the scene if there is one.
    void wantStart();
    /// Puts away what is in the middle, as far as something is left behind it. Returns whether something was.
    bool putAway(const Facts& facts);

    Middle middle(const Facts& facts) const;
    /// Returns the file that is being opened, "": none.
    const std::string& path() const { return path_; }
    const std::optional<OpenFailure>& failure() const { return failure_; }

private:
    bool opens(const Facts& facts) const { return facts.loading && !path_.empty(); }

    std::string path_;
    double begun_ = 0;
    std::optional<OpenFailure> failure_; // the user has not put it away
    bool startWanted_ = false;
    std::string noticePutAway_;
};

} // namespace relume
