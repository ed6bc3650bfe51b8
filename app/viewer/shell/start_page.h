#pragma once

#include <future>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/viewer/panels/panel.h"
#include "app/viewer/picture/scene_pictures.h"
#include "app/viewer/state/picture_area.h"
#include "app/viewer/state/recent_files.h"
#include "app/viewer/state/shipped_scenes.h"

namespace relume {

/// The page that the viewer begins with: recent files, the scenes that ship, how to open others.
class StartPage {
public:
    ~StartPage();
    /// Says whether it is on the screen. When it comes there it looks anew for what it lists, beside the main
    /// thread as far as that may take long.
    void show(bool on, const Preferences& preferences);
    /// Takes what was found. Returns how many recent files are gone, once, when that is known.
    std::optional<size_t> follow();
    /// Tells whether something is still looked for.
    bool looking() const { return asked_.valid() || pictures_.reading(); }
    /// Draws it over this part of the window. `back` says that there is a scene to go back to.
    void draw(const PanelContext& context, const PictureArea& area, bool back);

private:
    void drawHow(const PanelContext& context, bool back);
    void drawRecent(const PanelContext& context);
    bool drawRecentFile(const PanelContext& context, const RecentFile& file, bool newest);
    void drawScenes(const PanelContext& context);
    bool drawScene(const ShippedScene& scene, float width);

    bool shown_ = false;
    std::vector<ShippedScene> scenes_;
    std::future<std::set<std::string>> asked_;
    std::set<std::string> gone_; // paths of recent files
    ScenePictures pictures_;
};

} // namespace relume
