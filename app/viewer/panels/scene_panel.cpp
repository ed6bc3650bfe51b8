#include "app/viewer/panels/scene_panel.h"

#include "app/viewer/edits/light_edits.h"
#include "app/viewer/edits/object_edits.h"
#include "app/viewer/panels/scene_lists.h"
#include "app/viewer/panels/widgets.h"
#include "assets/base/error.h"

#include <algorithm>
#include <chrono>
#include <set>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {

// Measures the scene beside the main thread, on a copy without pictures, which outlives the scene if it must.
void ScenePanel::measure(const LoadedScene& scene, uint32_t size) {
    if (measuring_.valid()) {
        if (measuring_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        try {
            info_ = measuring_.get();
        } catch (const Error&) {
            info_.reset(); // the log has told what is wrong with the scene
        }
    }
    if (measured_ == scene.number && size_ == size) return;
    measured_ = scene.number;
    size_ = size;
    info_.reset();
    Scene copy;
    copy.path = scene.prepared.scene.path;
    copy.textures = scene.prepared.scene.textures;
    copy.materials = scene.prepared.scene.materials;
    copy.meshes = scene.prepared.scene.meshes;
    copy.instances = scene.prepared.scene.instances;
    copy.lights = scene.prepared.scene.lights;
    copy.sky.radiance = scene.prepared.scene.sky.radiance;
    copy.warnings = scene.prepared.scene.warnings;
    measuring_ =
        std::async(std::launch::async, [copy = std::move(copy), size] { return inspectScene(copy, size); });
}

void ScenePanel::drawStatistics(const LoadedScene& scene) {
    const Scene& file = scene.prepared.scene;
    if (ui::beginRows("statistics")) {
        ui::row("Meshes", fmt::format("{} in {} instances", file.meshes.size(), file.instances.size()));
        ui::row("Materials", fmt::format("{}, {} textures", file.materials.size(), file.textures.size()));
        if (!info_) {
            ui::row("Triangles", fmt::format("{}", scene.prepared.mesh.triangleCount()));
        } else {
            ui::row("Triangles",
                    fmt::format("{} ({} alpha-masked)", info_->triangles, info_->maskedTriangles));
            const glm::vec3 extent = info_->high - info_->low;
            ui::row("Extent", fmt::format("{:.3g} x {:.3g} x {:.3g} m", extent.x, extent.y, extent.z));
            ui::row("Surface", fmt::format("{:.4g} m^2", info_->area));
            ui::row("Emitters", fmt::format("{}, {:.3g} m^2", info_->emitters, info_->emitterArea));
            ui::row("UVs", fmt::format("{}, {} charts", info_->atlas.repacked ? "repacked" : "as they are",
                                       info_->charts));
            ui::row("Coverage", fmt::format("{:.1f} %", 100.0 * info_->statistics.coverage));
            ui::row("Density", fmt::format("{:.4g} texels/m", info_->statistics.texelDensityMean));
        }
        const std::vector<PhaseTime>& phases = scene.prepared.phases;
        ui::row("Loaded in", fmt::format("{:.2f} s, atlas {:.2f} s", secondsOf(phases, "load"),
                                         secondsOf(phases, "unwrap") + secondsOf(phases, "atlas")));
        ImGui::EndTable();
    }
    if (!info_) return;
    for (const std::string& warning : info_->warnings)
        ImGui::TextWrapped("%s", warning.c_str());
}

void ScenePanel::drawMaterial(const PanelContext& context, size_t index) {
    Document next = context.session.document();
    Material& material = next.edits.materials[index];
    const std::string name = nameOf(material.name, "material", index);
    const ui::ItemLog::Scope scope(context.items, name);
    glm::vec3 base(material.baseColor);
    ImGuiColorEditFlags flags = ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoAlpha;
    if (ui::colour("Base colour", &base.x, flags)) {
        material.baseColor = glm::vec4(glm::clamp(base, 0.0f, 1.0f), material.baseColor.a);
        context.edit("Base colour of " + name, next);
        context.sceneChanged();
    }
    if (ImGui::IsItemDeactivatedAfterEdit()) context.endEdit();
    EmissionParts parts = splitEmission(material.emission);
    bool changed = ui::colour("Emitted colour", &parts.colour.x, flags);
    bool ended = ImGui::IsItemDeactivatedAfterEdit();
    constexpr float kStep = 0.01f, kLeastStep = 0.01f, kMost = 1e9f;
    changed |=
        ui::dragFloat("Emission [cd/m^2]", &parts.strength, std::max(kStep * parts.strength, kLeastStep),
                      0.0f, kMost, "%.4g", ImGuiSliderFlags_AlwaysClamp);
    ended |= ImGui::IsItemDeactivatedAfterEdit();
    if (changed) {
        material.emission = typedColour(parts.colour) * parts.strength;
        context.edit("Emission of " + name, next);
        context.sceneChanged();
    }
    if (ended) context.endEdit();
}

// Draws the selected object, with the materials that it has.
void ScenePanel::drawObject(const PanelContext& context, const Scene& scene) {
    const auto instance = static_cast<uint32_t>(context.view.selected);
    const ui::ItemLog::Scope scope(context.items, "Object");
    ImGui::PushItemWidth(ImGui::GetFontSize() * -9.0f);
    object_.draw(context, instance);
    std::set<size_t> materials;
    for (const Primitive& primitive :
         scene.meshes[static_cast<size_t>(scene.instances[instance].mesh)].primitives)
        if (primitive.material >= 0) materials.insert(static_cast<size_t>(primitive.material));
    for (const size_t index : materials) {
        ImGui::PushID(static_cast<int>(index));
        ImGui::TextUnformatted(nameOf(scene.materials[index].name, "material", index).c_str());
        drawMaterial(context, index);
        ImGui::PopID();
    }
    ImGui::PopItemWidth();
}

void ScenePanel::drawMaterials(const PanelContext& context) {
    const std::vector<Material>& materials = context.session.document().edits.materials;
    for (size_t i = 0; i < materials.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        const Material& material = materials[i];
        const ImVec4 swatch(material.baseColor.r, material.baseColor.g, material.baseColor.b, 1.0f);
        const float line = ImGui::GetTextLineHeight();
        ImGui::ColorButton("swatch", swatch, ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoPicker,
                           {line, line});
        ImGui::SameLine();
        const std::string title = nameOf(material.name, "material", i) +
                                  (material.emission == glm::vec3(0.0f) ? "" : " (emits)") + "###material";
        const bool open = ImGui::TreeNode(title.c_str());
        ui::mark(title.c_str(), false);
        if (open) {
            ImGui::PushItemWidth(ImGui::GetFontSize() * -9.0f);
            drawMaterial(context, i);
            ImGui::PopItemWidth();
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
}

void ScenePanel::draw(const PanelContext& context) {
    const LoadedScene* scene = context.session.scene();
    if (scene == nullptr) {
        ImGui::TextWrapped("No scene: drop a file on the window, or press Ctrl+O.");
        return;
    }
    measure(*scene, context.session.document().bake.size);
    if (context.view.selected >= 0 && ui::header("Object", ImGuiTreeNodeFlags_DefaultOpen))
        drawObject(context, scene->prepared.scene);
    if (ui::header("Materials", ImGuiTreeNodeFlags_DefaultOpen)) drawMaterials(context);
    if (ui::header("Cameras and bookmarks", ImGuiTreeNodeFlags_DefaultOpen)) drawCameras(context, *scene);
    if (ui::header("Instances")) drawInstances(context, *scene);
    if (ui::header("Statistics", ImGuiTreeNodeFlags_DefaultOpen)) drawStatistics(*scene);
}

} // namespace relume
