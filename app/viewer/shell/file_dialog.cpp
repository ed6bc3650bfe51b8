#include "app/viewer/shell/file_dialog.h"

#include "app/viewer/panels/widgets.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <imgui.h>
#include <imgui_stdlib.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

bool isFolder(const std::string& path) {
    std::error_code code;
    return fs::is_directory(path, code);
}

std::string withoutSlash(std::string path) {
    while (path.size() > 1 && path.ends_with('/'))
        path.pop_back();
    return path;
}

/// Holds what the field's callback reads and changes.
struct Field {
    const PathCompletion& completion;
    bool& toEnd; // the cursor is to go there
};

// Completes the text when Tab is pressed in the field, as far as it can only go on one way. Behind a folder
// that was chosen one types on.
int onField(ImGuiInputTextCallbackData* data) {
    const Field& field = *static_cast<const Field*>(data->UserData);
    if (data->EventFlag == ImGuiInputTextFlags_CallbackAlways) {
        if (!field.toEnd) return 0;
        field.toEnd = false;
        data->CursorPos = data->BufTextLen;
        data->ClearSelection();
        return 0;
    }
    if (field.completion.matches.empty()) return 0;
    data->DeleteChars(0, data->BufTextLen);
    data->InsertChars(0, field.completion.text.c_str());
    return 0;
}

} // namespace

void FileDialog::open(Desc desc) {
    desc_ = std::move(desc);
    typed_ = desc_.path;
    listed_.clear();
    open_ = focus_ = true;
    toEnd_ = asks_ = false;
    ++opened_;
    complete();
}

void FileDialog::complete() {
    listed_ = typed_;
    completion_ = completePath(typed_, desc_.endings);
}

void FileDialog::list(const std::vector<std::string>& paths, const char* id) {
    constexpr size_t kLines = 10;
    const float line = ImGui::GetTextLineHeightWithSpacing();
    const float height = line * (0.6f + static_cast<float>(std::clamp<size_t>(paths.size(), 1, kLines)));
    ImGui::BeginChild(id, {0, height}, true);
    for (const std::string& path : paths) {
        if (!ui::selectable(path.c_str())) continue;
        typed_ = path;
        focus_ = toEnd_ = true;
        asks_ = false;
        if (!desc_.saves && !isFolder(path)) finish();
    }
    ImGui::EndChild();
}

void FileDialog::finish() {
    const std::string path = expandHome(typed_);
    if (path.empty()) return;
    const bool inside = path.ends_with('/');
    if (isFolder(path) && !(desc_.folder && inside)) { // goes on inside
        typed_ = inside ? path : path + "/";
        focus_ = toEnd_ = true;
        return;
    }
    if (desc_.saves && !asks_ && freePath(path) != path) {
        asks_ = true;
        return;
    }
    open_ = false;
    if (desc_.done) desc_.done(withoutSlash(path));
}

void FileDialog::draw() {
    if (!open_) return;
    const ImGuiViewport* viewport = ImGui::GetMainViewport();
    const ImVec2 centre = viewport->GetCenter();
    ImGui::SetNextWindowPos({centre.x, viewport->WorkPos.y + 0.15f * viewport->WorkSize.y},
                            ImGuiCond_Appearing, {0.5f, 0.0f});
    ImGui::SetNextWindowSize({std::min(40.0f * ImGui::GetFontSize(), viewport->WorkSize.x), 0});
    bool stays = true;
    ImGui::Begin((desc_.title + "###file").c_str(), &stays,
                 ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    if (focus_) ImGui::SetKeyboardFocusHere();
    focus_ = false;
    ImGui::SetNextItemWidth(-1);
    Field field{completion_, toEnd_};
    ImGui::PushID(opened_); // ImGui would select what was selected of the path before
    const bool entered =
        ImGui::InputText("##path", &typed_,
                         ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion |
                             ImGuiInputTextFlags_CallbackAlways,
                         onField, &field);
    ui::mark("Path", false);
    ImGui::PopID();
    if (typed_ != listed_) {
        complete();
        asks_ = false;
    }
    ImGui::TextDisabled("Tab completes, Enter takes it, Esc closes.");
    if (asks_) {
        ImGui::TextWrapped(desc_.folder ? "This folder exists. Files of these names are replaced."
                                        : "This file exists.");
        if (ui::button(desc_.folder ? "Write into it" : "Replace it")) finish();
        ImGui::SameLine();
        if (ui::button("Take a free name")) {
            typed_ = freePath(withoutSlash(expandHome(typed_)));
            asks_ = false;
            finish();
        }
    } else if (entered || ui::button(desc_.saves ? "Write" : "Open")) {
        finish();
    }
    if (open_ && !completion_.matches.empty()) list(completion_.matches, "matches");
    if (open_ && !desc_.recent.empty()) {
        ImGui::TextUnformatted("Recent");
        list(desc_.recent, "recent");
    }
    ImGui::End();
    if (!stays) open_ = false;
}

} // namespace relume
