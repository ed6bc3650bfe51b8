#pragma once

#include "app/viewer/panels/panel.h"

namespace relume {

/// What can be set of the selected object: where it stands, and whether it is there.
class ObjectPanel {
public:
    void draw(const PanelContext& context, uint32_t instance);

private:
    void drawAngles(const PanelContext& context, uint32_t instance, const std::string& name);

    // As they were typed: of an object that is tilted upright turn and roll are one.
    glm::vec3 angles_{0.0f}; // [degrees]
    uint32_t anglesOf_ = 0;
};

} // namespace relume
