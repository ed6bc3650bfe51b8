#pragma once

#include <functional>

#include "app/live/session.h"
#include "app/viewer/edits/light_edits.h"
#include "app/viewer/panels/item_log.h"
#include "app/viewer/picture/light_previews.h"
#include "app/viewer/state/log_buffer.h"
#include "app/viewer/state/preferences.h"
#include "app/viewer/state/shortcuts.h"
#include "app/viewer/state/view_state.h"
#include "app/viewer/window/frame_figures.h"
#include "app/viewer/window/messages.h"

namespace relume {

/// All that panels show and change. It lives in the viewer.
struct PanelContext {
    Session& session;
    const BakeStatus& status;
    ViewState& view;
    Preferences& preferences;
    const FrameFigures& figures;
    const LogBuffer& log;
    const Messages& messages;
    const LightList& lights;
    LightPreviews& previews;
    const PublishedMap* map; // the one that is shown, nullptr: none yet
    float exposure = 0;      // of the last picture [EV]
    double& budgetMs;        // how long a batch should take while the camera is still
    bool recording = false;
    std::function<void(Action, int)> perform;
    std::function<void(const ViewCamera&)> seeFrom; // from now on
    std::function<void()> sceneChanged;             // the picture of the scene is to be drawn anew
    std::function<void(const std::string&, const Document&)> edit; // Session::edit, told to the log
    std::function<void()> endEdit;
    std::function<void(const std::string&)> open;   // a scene
    std::function<void(const std::string&)> forget; // one of the recent scenes
    std::function<void(const GltfChoice&)> choose;  // what the scene's file offers
    std::function<void(const LightKey&)> selectLight;
    ui::ItemLog& items;
};

} // namespace relume
