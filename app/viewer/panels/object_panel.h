#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// The panel that sets where the selected object stands and whether it is there.
class ObjectPanel {
public:
    void draw(const PanelContext& context, uint32_t instance);

private:
    void drawAngles(const PanelContext& context, uint32_t instance, const std::string& name);

    // The angles are kept as they were typed, because turn and roll of an object that is tilted upright are
    // one.
    glm::vec3 angles_{0.0f}; // [degrees]
    uint32_t anglesOf_ = 0;
};

} // namespace relume
