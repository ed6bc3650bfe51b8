#pragma once

#include <optional>
#include <string>

#include "app/viewer/panels/panel.h"

namespace relume {

/// How the lightmap is made, and how far it is.
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

/// What the buttons and figures of the panel show; separate, as they stay above the settings.
void drawBakeProgress(const PanelContext& context);

} // namespace relume
