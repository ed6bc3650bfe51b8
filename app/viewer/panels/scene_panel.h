#pragma once

#include <future>
#include <optional>

#include "app/edit/scene_info.h"
#include "app/viewer/panels/object_panel.h"

namespace relume {

/// The panel that shows what the scene is made of, and edits its objects and materials.
class ScenePanel {
public:
    void draw(const PanelContext& context);

private:
    void measure(const LoadedScene& scene, uint32_t size);
    void drawStatistics(const LoadedScene& scene);
    void drawObject(const PanelContext& context, const Scene& scene);
    void drawMaterials(const PanelContext& context);
    void drawMaterial(const PanelContext& context, size_t index);

    ObjectPanel object_;
    uint64_t measured_ = 0; // number of the scene that `info_` is about
    uint32_t size_ = 0;     // of its lightmap
    std::future<SceneInfo> measuring_;
    std::optional<SceneInfo> info_;
};

} // namespace relume
