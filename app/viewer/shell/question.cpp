#include "app/viewer/shell/question.h"

#include "app/viewer/panels/widgets.h"

#include <algorithm>
#include <utility>

#include <imgui.h>

namespace relume {

void Question::ask(const std::string& text, std::vector<Answer> answers) {
    text_ = text;
    answers_ = std::move(answers);
}

void Question::give(size_t index) {
    const std::function<void()> done = std::move(answers_[index].done);
    close(); // the answer may ask again
    if (done) done();
}

bool Question::answer(int key) {
    for (size_t i = 0; i < answers_.size(); ++i) {
        if (answers_[i].key != key) continue;
        give(i);
        return true;
    }
    return false;
}

void Question::draw() {
    if (!isOpen()) return;
    const ImVec2 centre = ImGui::GetMainViewport()->GetCenter();
    ImGui::SetNextWindowPos(centre, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowFocus();
    ImGui::Begin("question", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    ImGui::PushTextWrapPos(30.0f * ImGui::GetFontSize());
    ImGui::TextUnformatted(text_.c_str());
    ImGui::PopTextWrapPos();
    size_t given = answers_.size();
    for (size_t i = 0; i < answers_.size(); ++i) {
        if (i > 0) ImGui::SameLine();
        if (ui::button(answers_[i].label.c_str())) given = i;
    }
    ImGui::End();
    if (given < answers_.size()) give(given);
}

} // namespace relume
