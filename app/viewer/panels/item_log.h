#pragma once

#include <map>
#include <string>

#include <glm/glm.hpp>

namespace relume::ui {

/// Tells on the standard error where the controls of panels are: "item: Bake/Method 203 96" in the window's
/// coordinates, whenever one is drawn for the first time or elsewhere. So that a test, or who follows a bug
/// report, can click them.
class ItemLog {
public:
    /// Names the controls that are drawn while it lives: "Scene", within it "Lamp".
    class Scope {
    public:
        Scope(ItemLog& log, const std::string& name);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        ItemLog& log_;
        size_t before_; // length of the path
        ItemLog* outer_;
    };

    explicit ItemLog(bool on) : on_(on) {}
    /// A control with its label; `at`: its middle.
    void add(const char* label, const glm::ivec2& at);
    /// The log of the innermost scope, nullptr outside of all: as ImGui has one context, there is one.
    static ItemLog* current();

private:
    bool on_ = false;
    std::string path_;
    std::map<std::string, glm::ivec2> places_;
};

} // namespace relume::ui
