#include "app/viewer/panels/scene_lists.h"

#include "app/viewer/edits/object_edits.h"
#include "app/viewer/panels/widgets.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {

void drawCameras(const PanelContext& context, const LoadedScene& scene) {
    const std::vector<Camera>& cameras = scene.prepared.scene.cameras;
    for (size_t i = 0; i < cameras.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ui::selectable((nameOf(cameras[i].name, "camera", i) + "###camera").c_str()))
            context.seeFrom(cameraOfFile(cameras[i], scene.geometry.bounds));
        ImGui::PopID();
    }
    std::error_code code;
    const std::string path =
        std::filesystem::absolute(context.session.path(), code).lexically_normal().string();
    const auto found = context.preferences.bookmarks.find(path);
    if (found != context.preferences.bookmarks.end()) {
        std::vector<Bookmark>& marks = found->second;
        for (size_t i = 0; i < marks.size(); ++i) {
            ImGui::PushID(static_cast<int>(cameras.size() + i));
            if (ImGui::SmallButton("x")) {
                marks.erase(marks.begin() + static_cast<ptrdiff_t>(i));
                ImGui::PopID();
                break;
            }
            ui::tip("Forget this bookmark");
            ImGui::SameLine();
            if (ui::selectable((marks[i].name + "###bookmark").c_str())) context.seeFrom(marks[i].camera);
            ImGui::PopID();
        }
    }
    if (ui::button("Store bookmark")) context.perform(Action::StoreBookmark, 0);
    ImGui::SameLine();
    if (ui::button("Reset camera")) context.perform(Action::ResetCamera, 0);
}

void drawInstances(const PanelContext& context, const LoadedScene& scene) {
    const std::vector<Instance>& instances = scene.prepared.scene.instances;
    const std::vector<Placement>& placements = context.session.document().edits.placements;
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(instances.size()));
    while (clipper.Step()) {
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            ImGui::PushID(i);
            const auto index = static_cast<size_t>(i);
            const std::string title = nameOf(instances[index].name, "instance", index) +
                                      (placements[index].hidden ? " (hidden)" : "") + "###instance";
            if (ui::selectable(title.c_str(), context.view.selected == i)) {
                context.view.selected = context.view.selected == i ? -1 : i;
                context.view.light.reset();
                context.sceneChanged();
            }
            ui::tip("F frames what is selected");
            ImGui::PopID();
        }
    }
}

} // namespace relume
