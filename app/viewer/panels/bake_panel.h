#pragma once

#include <optional>
#include <string>

#include "app/viewer/panels/panel.h"

namespace relume {

/// The panel that sets how the lightmap is made and shows how far it is.
class BakePanel {
public:
    void draw(const PanelContext& context);

private:
    void drawMethod(bool& done);
    void drawPairs(bool& done);
    void drawLinks(bool& done);
    void drawTracer(bool& done);
    void drawTransport(bool& done);
    void drawLightmap(bool& done);
    void drawStop(bool& done);
    void settle(const PanelContext& context, bool done);

    Document draft_;       // what the controls show
    bool waiting_ = false; // the draft contradicts itself and is not applied
    bool active_ = false;  // a control was held or typed in when last drawn
    std::string problem_;
};

/// Draws the buttons and figures of the panel. They are separate because they stay above the settings.
void drawBakeProgress(const PanelContext& context);

} // namespace relume
