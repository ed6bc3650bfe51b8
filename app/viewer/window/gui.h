#pragma once

#include "app/viewer/window/window.h"

namespace relume {

/// Dear ImGui in a window: its context, fonts and style. Belongs to the window's context; one at a time.
class Gui {
public:
    explicit Gui(Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    /// Tells it what happened to the window.
    void feed(const WindowEvent& event);
    /// Starts a frame; scale: of text and controls, a change of which makes new fonts.
    void begin(float scale);
    /// Ends it and draws it into the window.
    void end();

    bool wantsMouse() const;    // the cursor is over a panel, or drags something of one
    bool wantsKeyboard() const; // something is typed
    /// Whether something blinks or is dragged.
    bool animates() const;

private:
    void setScale(float scale);
    void feedSeen();

    Window& window_;
    float scale_ = 0;
    std::vector<int> pressed_;          // keys, since the frame before
    std::vector<WindowEvent> releases_; // of such keys, which the next frame is to see held
    std::vector<WindowEvent> seen_;     // of those that the last frame saw held
};

} // namespace relume
