#pragma once

namespace relume {

/// The parts of a window that are to be drawn.
struct Redraw {
    bool scene = false; // the picture of the scene; else the last one is shown again
    bool any = false;   // anything at all
};

/// Decides when a window is drawn: at once where the user did something, and otherwise so rarely that drawing
/// leaves most of a slow machine to the bake. It knows no clock: the caller gives all times [s].
class RedrawPacer {
public:
    /// Says that the user did something; what panels show may settle over several frames.
    void input();
    /// Says that the user made the scene look different: by camera, view or an edit.
    void sceneChanged() { scene_ = true; }
    /// Says that a map with more light came.
    void newMap() { map_ = true; }
    /// Says that figures beside the scene may have changed.
    void statusChanged() { status_ = true; }
    /// Says that a picture beside the scene has changed. It is drawn with the figures, and waited for.
    void smallPictureChanged() { status_ = smallPicture_ = true; }
    /// Says whether something moves by itself: then every frame is drawn.
    void animate(bool on) { animated_ = on; }

    /// Tells whether all that the user did, and every map and picture that came, has been drawn.
    bool settled() const { return settling_ == 0 && !scene_ && !map_ && !smallPicture_ && !animated_; }

    Redraw due(double now) const;
    /// Returns how long nothing will be due unless something is told, `idle` at most.
    double wait(double now, double idle) const;
    /// Says that what due() told was drawn by `end`. `cost` is the time that it took less what was only
    /// waited for.
    void drawn(const Redraw& what, double end, double cost);

private:
    double nextPaced() const;

    int settling_ = 3; // frames that are drawn whatever happens
    bool scene_ = true, map_ = false, status_ = false, smallPicture_ = false, animated_ = false;
    double lastEnd_ = 0, lastCost_ = 0;
    double sceneCost_ = 0; // of the last picture of the scene
};

} // namespace relume
