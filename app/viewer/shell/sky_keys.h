#pragma once

#include <string>

#include "app/viewer/picture/shown_lights.h"
#include "app/viewer/picture/sky_pictures.h"
#include "app/viewer/shell/editing.h"
#include "app/viewer/shell/file_dialog.h"

namespace relume {

/// Gives the sky a picture, or none, as the user asks, and keeps the picture that is shown what the document
/// says: one that an undo brings back is read again.
class SkyKeys {
public:
    /// All that it is given must outlive it.
    SkyKeys(const Session& session, SceneView& picture, ShownLights& lights, Editing& editing,
            Feedback& feedback);

    /// Asks for a picture. The dialog begins in the folder `begin`, which ends in a slash.
    void choose(FileDialog& dialog, const std::string& begin);
    void clear();
    /// Says that another scene came, or the same one, read anew: a picture that was chosen for the former one
    /// is none of its sky.
    void sceneCame(bool kept);
    void follow();
    bool reading() const { return !pictures_.reading().empty(); }

private:
    void take(const SkyPictures::Result& result);

    const Session& session_;
    SceneView& picture_;
    ShownLights& lights_;
    Editing& editing_;
    Feedback& feedback_;
    SkyPictures pictures_;
    std::string bad_; // the document's picture, where it could not be read
};

} // namespace relume
