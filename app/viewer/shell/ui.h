#pragma once

#include <string>

#include <glm/glm.hpp>

#include "app/viewer/panels/bake_panel.h"
#include "app/viewer/panels/lights_panel.h"
#include "app/viewer/panels/panel.h"
#include "app/viewer/panels/scene_panel.h"
#include "app/viewer/shell/file_dialog.h"
#include "app/viewer/shell/question.h"
#include "app/viewer/window/messages.h"

namespace relume {

/// All that is drawn over the scene or beside it: menus, the side panel with its tabs, status, dialogs.
class Ui {
public:
    /// The part of the window that is left for the scene, in screen coordinates from the upper left.
    struct Area {
        glm::vec2 corner{0.0f}, size{0.0f};
    };
    /// Draws all between Gui::begin() and end(), or with `hidden` only messages and dialogs.
    Area draw(const PanelContext& context, bool hidden, float scale);

    /// Closes what is in front. Returns false where nothing was open.
    bool closeDialog();
    void toggleHelp() { help_ = !help_; }
    void showPanel(size_t index) { wantedPanel_ = static_cast<int>(index); }
    FileDialog& files() { return files_; }
    Question& question() { return question_; }
    Messages& messages() { return messages_; }
    const Messages& messages() const { return messages_; }

private:
    float drawMenus(const PanelContext& context);
    float drawStatus(const PanelContext& context);
    void drawSide(const PanelContext& context, float top, float bottom, float scale);
    void drawTab(const PanelContext& context, size_t index);
    void drawHelp();
    void drawMessages(const Area& area);

    BakePanel bake_;
    ScenePanel scene_;
    LightsPanel lights_;
    FileDialog files_;
    Question question_;
    Messages messages_;
    bool help_ = false;
    int wantedPanel_ = -1;
};

/// Tells how the scene is looked at: "Lit", "Light: Lamp", "Lights: rest" where the light shares a layer.
std::string viewTitle(const ViewState& view, const LightList& lights, const std::vector<LightGroup>& groups);

/// Returns one line about the bake, for status bars and captions: phase, method, pass, error, rays.
std::string statusLine(const BakeStatus& status);

} // namespace relume
