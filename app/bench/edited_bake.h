#pragma once

#include <memory>
#include <optional>

#include "app/bench/edits_report.h"
#include "app/bench/light_difference.h"
#include "app/text/stopwatch.h"
#include "assets/atlas/lightmap_atlas.h"
#include "bake/baker/baker.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// Steps the solver until it is done. It makes at least one step, by which a solver that was done hears of an
/// edit. Throws Error on Ctrl-C.
void bakeToEnd(Solver& solver);

/// The light that a moved lamp's picture is compared with, after the move.
struct MoveReferences {
    PatchLight lamp; // its own light
    PatchLight all;
};

/// A bake in layers whose scene is edited. Every edit is timed: step(), edit() and liveLight() by the clock.
/// The first of the scene's lights is the one that moves.
class EditedBake {
public:
    /// Makes the baker, but restart() makes the solver. Throws Error.
    EditedBake(const vk::Device& device, const Scene& scene, WorldMesh mesh, const BakeSettings& settings);

    const Baker& baker() const { return *baker_; }
    const Scene& scene() const { return scene_; }
    const SolverProgress& progress() { return solver().progress(); }
    /// Returns the first light's layer, for a unit of its weight.
    PatchLight firstLamp();

    /// Bakes from nothing to the end, with these lights. Returns how long it took [s]. Throws Error where
    /// some of them would share a layer.
    double restart(const std::vector<Light>& lights, const SolverSettings& settings);
    /// Edits to lights that differ in intensity and colour alone. Returns how long it takes until there is a
    /// picture [s].
    double weigh(const std::vector<Light>& lights);
    /// Edits to lights of which the first one has moved. Returns all figures of the move but those of its
    /// undo.
    MeasuredMove move(const std::vector<Light>& lights, const MoveReferences& references);
    /// Goes back to the lights before, and fills in the figures of the undo. `first` is firstLamp() as it was
    /// then.
    void undo(const std::vector<Light>& lights, const PatchLight& first, MeasuredMove& edit);
    /// The times of an edit that all layers follow [s].
    struct Seen {
        double first = 0;                 // until there is a picture of it, all lights in one
        double all = 0;                   // until all layers have it
        double end = 0;                   // until they have the error that is asked for
        std::optional<double> firstError; // relRMSE of that picture against the one of the layers
    };
    Seen repaint(uint32_t material, const glm::vec4& baseColor);

    struct Replacement {
        double follow = 0; // for patches, triangles and tracer [s]; `seen` has it in its times
        Seen seen;
    };
    /// Puts an object elsewhere. Returns nothing where that cannot be followed, and the object stays where it
    /// is.
    std::optional<Replacement> place(uint32_t instance, const glm::mat4& transform,
                                     const LightmapAtlas& atlas);
    PatchLight light() { return solver().light(); }

private:
    LayerSolver& solver() { return *baker_->layers(); }
    void apply(const SceneEdits& edits);
    SceneEdits editsTo(const std::vector<Light>& lights) const;
    const Layer* movedLayer();
    Seen seeLayers(uint64_t LightCacheKey::*changed, uint64_t before, Stopwatch& watch);

    const vk::Device& device_;
    Scene scene_; // which the baker edits
    std::unique_ptr<Baker> baker_;
};

} // namespace relume
