#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/base/phase_clock.h"
#include "bake/baker/bake_settings.h"
#include "bake/baker/edit_decision.h"
#include "bake/baker/former_bake.h"
#include "bake/baker/make_solver.h"
#include "bake/baker/memory_needs.h"
#include "bake/output/lightmap.h"
#include "bake/ranks/chunk_deal.h"
#include "bake/surface/surface_colours.h"

namespace relume {

class ObjectMover;

/// Counts over all moves of objects that a bake has followed.
struct MoveCounters {
    uint64_t texels = 0; // moves after which some texels have another patch, or one of them has none
    double seconds = 0;  // for patches, triangles and tracer
};

/// How far a constructor prepares a bake.
enum class Preparation {
    Whole,
    // Until there is a solver whose light may be looked at meanwhile: it takes no patch to lie inside
    // something and starts in the middle of texels. complete() and resetSolver() are to follow.
    FirstGlance
};

/// One bake of one scene: CIT, patches, tracer, solver. The constructor prepares everything; then step the
/// solver.
class Baker {
public:
    /// The largest lightmap edge.
    static constexpr uint32_t kMaxSize = kMaxPageSize;

    /// Prepares everything. Throws Error when the size does not fit the device's memory (before anything is
    /// allocated), no texel is covered or the tracer cannot run. Device and scene must outlive it. phaseHook
    /// hears what comes next ("cit", "tracer", ...), some of it more than once; what it throws ends the
    /// preparation, as does what this thread's watch throws.
    using PhaseHook = std::function<void(const char* phase)>;
    Baker(const vk::Device& device, const Scene& scene, BakeSurfaces surfaces, const BakeSettings& settings,
          PhaseHook phaseHook = {});
    /// Does likewise for a scene that edits may change: nobody but apply() and restart() may do so from now
    /// on. Where layers are baked it goes on with what a former bake of the level has: what stays as it was
    /// is neither traced nor made again, and what comes of it is a fresh bake.
    /// A first glance is given only where layers are baked and triangles are traced, of not too many patches
    /// and to a bake that does not go on with a former one; isWhole() tells.
    Baker(const vk::Device& device, Scene& scene, BakeSurfaces surfaces, const BakeSettings& settings,
          PhaseHook phaseHook = {}, Preparation preparation = Preparation::Whole);
    ~Baker();

    /// Tells whether everything is prepared.
    bool isWhole() const { return whole_; }
    /// Prepares what a first glance left. The solver may be looked at from the phase hook and watch until it
    /// returns. Throws what these throw.
    void complete();

    /// Gives up what a bake of the same settings can go on with; nothing without layers. What is left of this
    /// one is to be destroyed.
    std::optional<FormerBake> release();

    Solver& solver() { return *solver_.solver; }
    /// Returns the same solver where each light has a layer, else nullptr.
    LayerSolver* layers() { return solver_.layers; }
    const LayerSolver* layers() const { return solver_.layers; }
    /// Makes another solver of the same patches, which starts from no light; `transport` must stay as it is.
    /// Throws Error when its method cannot run: then there is no solver any more.
    void resetSolver(const SolverSettings& settings);
    /// Does so after changing lights, sky and colours as wanted; objects and the sky's picture must be those
    /// that are baked.
    void restart(const SceneEdits& wanted, const SolverSettings& settings);
    /// Edits what is baked: takes over what differs from the scene, and tells the solver, even where nothing
    /// does. After a Later the caller asks again, or forgets the edit for a newer one.
    Applied apply(const BakeEdits& edits);
    /// Returns what all moves of objects so far have come to.
    const MoveCounters& moves() const { return moves_; }
    Tracer& tracer() { return *tracer_; }
    /// Returns the tracer's name and why it was taken: "embree (software device)".
    const std::string& tracerChoice() const { return tracerChoice_; }
    /// Returns the device's pool of threads, for what is done with the bake's results on the CPU.
    WorkerPool& workers() const { return device_.workers(); }
    const PatchSet& patches() const { return patches_; }
    LightBuffers& light() { return *light_; }
    const std::vector<PhaseTime>& phases() const { return phases_; }
    /// Returns how many patches lie inside something and have not stepped aside.
    uint32_t invalidPatches() const;
    /// Returns the lightmap of the last finished pass. Where sumsLayers(), it is the sum of weight times
    /// layer (LayerSum), seams filled layer by layer: the solver's own light but for the last bits.
    FloatImage lightmap(LightmapDesc desc) const;
    /// Tells whether each layer of a light has come to its end, and lighting is asked for, which they sum up
    /// to.
    bool sumsLayers(const LightmapDesc& desc) const;
    /// Returns the bytes of its buffers that are in the host's memory because the device has no room for
    /// them.
    uint64_t spilledBytes() const;
    /// Returns Solver::errors() as a grey image in lighting's unit; texels beside charts stay empty. Throws
    /// Error when there is nothing to tell yet.
    FloatImage errorMap() const;

private:
    /// Holds what stays of a former bake.
    struct Carry {
        FormerBake& former;
        PatchCarry patches;
        ObjectMove move = {};
    };
    Baker(const vk::Device& device, const Scene& scene, Scene* editable, BakeSurfaces surfaces,
          const BakeSettings& settings, PhaseHook phaseHook, Preparation preparation);
    void requireRoom(BakeSurfaces& surfaces) const;
    void planSpill();
    bool goesOnWith(const FormerBake* former, const LightmapPages& pages) const;
    void makePatches(WorldMesh mesh, const FormerBake* former, PhaseClock& clock);
    void makeTracers(TreeAhead* tree);
    bool makeGlance();
    void findValidity(Carry* carry);
    void makeVoxels();
    std::optional<Carry> carryFrom(FormerBake* former);
    LayerCarry layerCarry(const Carry& carry) const;
    void findInvalid(Carry* carry);
    void searchInside();
    void makeCovers();
    vk::Buffer makeDeviceCovers() const;
    std::optional<ObjectMove> moveObjects(const LightmapAtlas* atlas);
    bool repaint(const BakeEdits& edits, const std::vector<uint8_t>& materials);
    void updateMaterials();
    void onPhase(const char* phase, double done = -1.0) const;
    Ranks& ranks() const { return settings_.ranks ? *settings_.ranks : oneProcess(); }
    SolverInput solverInput() { return {device_, scene_, patches_, *light_, *tracer_, ranks()}; }

    const vk::Device& device_;
    const Scene& scene_;
    Scene* editable_; // scene_, where it may be changed
    BakeSettings settings_;
    PhaseHook phaseHook_;
    PatchSet patches_;
    std::unique_ptr<LightBuffers> light_;
    std::unique_ptr<SurfaceColours> colours_;
    std::unique_ptr<ObjectMover> mover_; // where layers are baked, whose solver follows edits
    std::unique_ptr<Tracer> tracer_;
    MadeSolver solver_;
    std::string tracerChoice_;
    std::vector<PhaseTime> phases_;
    bool whole_ = true;
    uint32_t inside_ = 0;            // patches whose texel's own point lies inside something
    std::vector<uint32_t> touching_; // patches that may lie upon a surface (mayTouch), of this process
    MoveCounters moves_;
};

} // namespace relume
