#pragma once

#include <utility>

#include "app/viewer/window/window.h"

struct ImFont;

namespace relume {

/// Dear ImGui in a window: its context, fonts and style. It belongs to the window's context; there is one at
/// a time.
class Gui {
public:
    explicit Gui(Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Tells Dear ImGui what happened to the window.
    void feed(const WindowEvent& event);
    /// Starts a frame. `scale` is that of text and controls; when it changes, the fonts are made anew.
    void begin(float scale);
    /// Ends the frame and draws it into the window.
    void end();

    /// Says whether the arrow keys go through the controls, and Enter and Space press them, from the next
    /// frame on. Meanwhile Tab is counted.
    void navigate(bool on);
    /// Returns how often Tab was pressed since the last call; with Shift it counts below 0.
    int takeTabs() { return std::exchange(tabs_, 0); }

    bool wantsMouse() const;    // the cursor is over a panel, or drags something of one
    bool wantsKeyboard() const; // something is typed
    /// Tells whether input waits for the next frame: Dear ImGui 1.87 on takes what happens to one button or
    /// key in one frame each.
    bool hasInputLeft() const;
    /// Tells whether something blinks or is dragged.
    bool animates() const;
    /// Returns the font of headings, which is larger. It is valid within a frame.
    static ImFont* titleFont();

private:
    void setScale(float scale);
    void feedSeen();
    void feedKey(const WindowEvent& event, int state);

    Window& window_;
    float scale_ = 0;
    bool navigates_ = false;
    int tabs_ = 0;                      // for takeTabs()
    std::vector<int> pressed_;          // keys, since the frame before
    std::vector<WindowEvent> releases_; // of such keys: the next frame must still see them held
    std::vector<WindowEvent> seen_;     // of those that the last frame saw held
};

} // namespace relume
