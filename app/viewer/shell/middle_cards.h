#pragma once

#include <functional>
#include <optional>

#include "app/viewer/panels/panel.h"
#include "app/viewer/state/middle.h"
#include "app/viewer/state/picture_area.h"
#include "app/viewer/state/picture_notice.h"

namespace relume {

/// All that the middle of the window shows.
struct MiddleView {
    Middle middle;
    int tabs = 0;          // how often Tab was pressed, see Gui::takeTabs()
    bool scene = false;    // there is one behind it
    std::string opening;   // the file that is being opened
    LoadProgress progress; // of it
    std::optional<OpenFailure> failure;
    std::optional<PictureNotice> notice;
    std::function<void(const std::string&)> copy; // puts a text into the clipboard
};

/// Draws the card, if there is one, in the middle of the picture, or of the window where that is too narrow.
void drawMiddleCard(const PanelContext& context, const MiddleView& view, const PictureArea& area);

} // namespace relume
