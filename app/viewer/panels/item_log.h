#pragma once

#include <map>
#include <string>

#include <glm/glm.hpp>

namespace relume::ui {

/// Tells on the standard error where the controls of panels are, so that a test, or someone who follows a bug
/// report, can click them: "item: Bake/Method 203 96" in the window's coordinates, whenever one is drawn for
/// the first time or elsewhere.
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
    /// Adds a control with its label; `at` is its middle.
    void add(const char* label, const glm::ivec2& at);
    /// Says that the keyboard is at the control with this label.
    void focused(const char* label);
    /// Returns the log of the innermost scope, nullptr outside of all. There is one because ImGui has one
    /// context.
    static ItemLog* current();

private:
    std::string nameOf(const char* label) const;

    bool on_ = false;
    std::string path_, focused_; // focused_: the control that the keyboard was at last
    std::map<std::string, glm::ivec2> places_;
};

} // namespace relume::ui
