#pragma once

namespace relume::ui {

/// Returns the control that Tab leads to: `steps` (below 0: back) from the one that has the focus, of `count`
/// that follow one another in a ring. -1 stands for none.
int tabStop(int focused, int steps, int count);

/// Lets Tab go through all controls, in the order in which they are drawn. ImGui's own goes through fields of
/// text only (before 1.89).
class TabOrder {
public:
    /// Controls that are drawn while it lives take part. Of two, the inner one counts.
    class Scope {
    public:
        explicit Scope(TabOrder& order);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        TabOrder* outer_;
    };

    /// Begins a frame, before which Tab was pressed so often; with Shift it counts below 0.
    void begin(int steps);
    /// Adds the control that was drawn last.
    void add();
    /// Returns the order of the innermost scope, nullptr outside of all. There is one because ImGui has one
    /// context.
    static TabOrder* current();

private:
    int wanted_ = -1, drawn_ = 0;  // of this frame
    int focused_ = -1, count_ = 0; // of the frame before; focused_: also of this one, as far as it is drawn
};

} // namespace relume::ui
