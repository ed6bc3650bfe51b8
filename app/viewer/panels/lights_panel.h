#pragma once

#include <string>

#include "app/viewer/panels/panel.h"

namespace relume {

/// The panel with all lights as a mix board, and below it what can be set of the selected one.
class LightsPanel {
public:
    void draw(const PanelContext& context);

private:
    void drawBoard(const PanelContext& context);
    void drawPreview(const PanelContext& context, const LightSource& source);
    void drawRow(const PanelContext& context, const LightSource& source);
    void drawAdd(const PanelContext& context);
    void drawInspector(const PanelContext& context);
    void drawLamp(const PanelContext& context, const LightSource& source);
    void drawName(const PanelContext& context, const LightSource& source);
    void drawAngles(const PanelContext& context, const LightSource& source);

    // The angles are kept as they were typed, because turn and roll of a light that shines straight down are
    // one.
    glm::vec3 angles_{0.0f}; // [degrees]
    LightKey anglesOf_;
    std::string name_;    // as it is typed
    bool naming_ = false; // the field was active when last drawn
};

} // namespace relume
