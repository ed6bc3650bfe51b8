#pragma once

#include <functional>

#include "app/live/bake_desk.h"
#include "app/live/scene_bake.h"

namespace relume {

/// Writes the lightmap of a bake as it stands; the log tells how it went. At the end the file has the bytes
/// of a bake without a window. Before, it has what is on screen, which lightNow() returns for each patch. An
/// export that goes wrong, or that is of another scene, leaves the bake as it is. There is a baker.
void exportLightmap(const BakeOrders::Export& wanted, const SceneBake& bake,
                    const std::function<std::vector<glm::vec4>()>& lightNow);

/// Writes the level of a bake with such a lightmap as an engine reads it (app/export), or a page with the mix
/// board of its layers as they stand (app/export/web), likewise.
void exportForEngine(const BakeOrders::EngineExport& wanted, const vk::Device& device, const SceneBake& bake,
                     const std::function<std::vector<glm::vec4>()>& lightNow);

} // namespace relume
