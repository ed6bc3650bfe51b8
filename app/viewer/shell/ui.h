#pragma once

#include <string>

#include "app/viewer/panels/bake_panel.h"
#include "app/viewer/panels/lights_panel.h"
#include "app/viewer/panels/panel.h"
#include "app/viewer/panels/scene_panel.h"
#include "app/viewer/panels/tab_order.h"
#include "app/viewer/shell/file_dialog.h"
#include "app/viewer/shell/middle_cards.h"
#include "app/viewer/shell/question.h"
#include "app/viewer/shell/start_page.h"
#include "app/viewer/state/picture_area.h"

namespace relume {

/// All that is drawn over the scene or beside it: menus, the side panel with its tabs, status, dialogs.
class Ui {
public:
    explicit Ui(bool logItems) : items_(logItems) {}
    /// Draws all between Gui::begin() and end(), or only messages and dialogs where the view is bare. Returns
    /// the part of the window that is left for the scene.
    PictureArea draw(const PanelContext& context, const MiddleView& middle, float scale);

    /// Closes what is in front. Returns false where nothing was open.
    bool closeDialog();
    void toggleHelp() { help_ = !help_; }
    void showPanel(size_t index) { wantedPanel_ = static_cast<int>(index); }
    /// Tells whether the keys go through what is in the middle of the window: nothing is in front of it.
    bool takesKeys(const Middle& middle) const;
    FileDialog& files() { return files_; }
    StartPage& start() { return start_; }
    const StartPage& start() const { return start_; }
    Question& question() { return question_; }
    ui::ItemLog& items() { return items_; }

private:
    float drawMenus(const PanelContext& context);
    float drawStatus(const PanelContext& context);
    void drawMiddle(const PanelContext& context, const MiddleView& middle, const PictureArea& picture,
                    const PictureArea& all);
    void drawSide(const PanelContext& context, float top, float bottom, float scale);
    void drawTab(const PanelContext& context, size_t index);
    void drawHelp();

    BakePanel bake_;
    ScenePanel scene_;
    LightsPanel lights_;
    StartPage start_;
    ui::TabOrder tabs_; // of what is in the middle of the window
    FileDialog files_;
    Question question_;
    ui::ItemLog items_;
    bool help_ = false;
    int wantedPanel_ = -1;
};

/// Returns one line about the bake, for status bars and captions: phase, method, pass, error, rays.
std::string statusLine(const BakeStatus& status);

} // namespace relume
