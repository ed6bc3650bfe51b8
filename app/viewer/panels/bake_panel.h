#pragma once

#include "app/viewer/panels/panel.h"
#include "app/viewer/state/bake_draft.h"

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

    BakeDraft draft_;     // what the controls show
    bool active_ = false; // a control was held or typed in when last drawn
};

/// Draws the buttons and figures of the panel. They are separate because they stay above the settings.
void drawBakeProgress(const PanelContext& context);

} // namespace relume
