#include "app/viewer/panels/item_log.h"

#include <cstdio>

namespace relume::ui {
namespace {

ItemLog* innermost = nullptr;

} // namespace

ItemLog::Scope::Scope(ItemLog& log, const std::string& name)
    : log_(log), before_(log.path_.size()), outer_(innermost) {
    log_.path_ += name + "/";
    innermost = &log_;
}

ItemLog::Scope::~Scope() {
    log_.path_.resize(before_);
    innermost = outer_;
}

ItemLog* ItemLog::current() {
    return innermost;
}

std::string ItemLog::nameOf(const char* label) const {
    const std::string text = label;
    return path_ + text.substr(0, text.find("##")); // behind it is what only ImGui reads
}

void ItemLog::focused(const char* label) {
    if (!on_) return;
    const std::string name = nameOf(label);
    if (name == focused_) return;
    focused_ = name;
    std::fprintf(stderr, "focus: %s\n", name.c_str());
}

void ItemLog::add(const char* label, const glm::ivec2& at) {
    if (!on_) return;
    const std::string name = nameOf(label);
    const auto [known, fresh] = places_.try_emplace(name, at);
    if (!fresh && known->second == at) return;
    known->second = at;
    std::fprintf(stderr, "item: %s %d %d\n", name.c_str(), at.x, at.y);
}

} // namespace relume::ui
