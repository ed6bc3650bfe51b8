#pragma once

namespace relume {

/// What of a window is to be drawn.
struct Redraw {
    bool scene = false; // the picture of the scene; else the last one is shown again
    bool any = false;   // anything at all
};

/// Decides when a window is drawn: at once where the user did something, and otherwise so rarely that drawing
/// leaves most of a slow machine to the bake. Knows no clock: all times [s] are the caller's.
class RedrawPacer {
public:
    /// The user did something; what panels show may settle over several frames.
    void input();
    /// The scene looks different by the user's doing: camera, view, an edit.
    void sceneChanged() { scene_ = true; }
    /// A map with more light came.
    void newMap() { map_ = true; }
    /// Figures beside the scene may have changed.
    void statusChanged() { status_ = true; }
    /// Something moves by itself: every frame is drawn.
    void animate(bool on) { animated_ = on; }

    Redraw due(double now) const;
    /// How long nothing will be due unless something is told; `idle` at most.
    double wait(double now, double idle) const;
    /// What due() said was drawn from `start` to `end`; cost: of that the machine's time, `end - start` less
    /// what was waited for.
    void drawn(const Redraw& what, double end, double cost);

private:
    double nextPaced() const;

    int settling_ = 3; // frames that are drawn whatever happens
    bool scene_ = true, map_ = false, status_ = false, animated_ = false;
    double lastEnd_ = 0, lastCost_ = 0;
    double sceneCost_ = 0; // of the last picture of the scene
};

} // namespace relume
