#pragma once

#include <optional>
#include <string>

#include "app/live/live_bake.h"
#include "app/viewer/state/shortcuts.h"

namespace relume {

/// Says why the picture shows nothing, or no light, and what helps.
struct PictureNotice {
    std::string title, text;
    std::optional<Action> mend; // an action that helps
};

/// Says what the picture of a scene shows, and what the bake has to say.
struct PictureFacts {
    BakeStatus::Phase phase = BakeStatus::Phase::Idle;
    std::string doing = {};         // as in BakeStatus
    size_t objects = 0, hidden = 0; // of the scene
    bool flat = false;              // the lightmap is shown as a flat picture
    bool map = false;               // there is a lightmap of this scene
};

/// Returns what is to be said in the middle of the picture, if anything is.
std::optional<PictureNotice> pictureNotice(const PictureFacts& facts);

} // namespace relume
