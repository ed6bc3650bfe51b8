#pragma once

#include <string>

#include "app/viewer/state/preferences.h"

namespace relume {

/// Returns what a viewer writes into the file of preferences: its own settings, and the recent scenes and
/// bookmarks of the file with what came and went here. `before` is what this viewer read or wrote last, `own`
/// what it has now, and `theirs` what the file holds now, which another viewer may have written. A scene that
/// was opened here comes first. A bookmark whose name is taken there by another gets a free name.
Preferences mergePreferences(const Preferences& before, const Preferences& own, const Preferences& theirs);

/// Holds the preferences of a viewer, and their file, which several viewers may have in use at once.
class KeptPreferences {
public:
    /// Reads the file as readPreferences() does. "" stands for no file: nothing is kept then.
    explicit KeptPreferences(std::string path);

    Preferences& values() { return own_; }
    const Preferences& values() const { return own_; }
    /// Writes the file as mergePreferences() has it, one viewer at a time, and takes over what that is. Where
    /// it cannot be written, a warning says so.
    void save();

private:
    std::string path_;
    Preferences own_, before_;
};

} // namespace relume
