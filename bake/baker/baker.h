#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/output/lightmap.h"
#include "bake/solver/solver.h"
#include "bake/surface/surface_colours.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"

namespace relume {

struct LightmapAtlas;
struct ObjectMove;
class ObjectMover;

struct BakeSettings {
    uint32_t size = 512; // lightmap edge [texels]
    bool conservative = false;
    TracerKind tracer = TracerKind::Auto;
    VoxelSettings voxels;  // of the voxel tracer; a ratio above 0 mixes it with `tracer`
    SolverSettings solver; // solver.transport.rtrad makes the whole bake follow RTRad
};

/// The seconds of one named phase.
struct PhaseTime {
    std::string name;
    double seconds = 0;
};

/// One bake of one scene: CIT, patches, tracer, solver. The constructor prepares everything; then step the
/// solver.
class Baker {
public:
    /// The largest lightmap edge.
    static constexpr uint32_t kMaxSize = kMaxLightmapSize;

    /// Prepares everything. Throws Error when the size does not fit the device's memory (before anything is
    /// allocated), no texel is covered or the tracer cannot run. Device and scene must outlive it. phaseHook
    /// hears what comes next ("cit", "tracer", ...), some of it more than once; what it throws ends the
    /// preparation, as does what this thread's watch throws.
    using PhaseHook = std::function<void(const char* phase)>;
    Baker(const vk::Device& device, const Scene& scene, WorldMesh mesh, const BakeSettings& settings,
          PhaseHook phaseHook = {});
    ~Baker();

    Solver& solver() { return *solver_; }
    /// Makes another solver of the same patches, which starts from no light; `transport` must stay as it is.
    /// Throws Error when its method cannot run: then there is no solver any more.
    void resetSolver(const SolverSettings& settings);
    /// Takes over colours and strengths of materials as the scene has them now; not whether they are masked
    /// or emit at all. This is for a solver that follows edits, which must be told afterwards.
    void updateMaterials();
    /// Moves, hides and shows objects as the scene has them now: for a solver that follows edits
    /// (LayerSolver::moveObjects must be told of what comes back). Returns nothing where that cannot be
    /// followed; then all is as it was, and another Baker is needed. The atlas is the one that the mesh was
    /// made with.
    std::optional<ObjectMove> moveObjects(const LightmapAtlas& atlas);
    Tracer& tracer() { return *tracer_; }
    /// Returns the tracer's name and why it was taken: "embree (software device)".
    const std::string& tracerChoice() const { return tracerChoice_; }
    const PatchSet& patches() const { return patches_; }
    LightBuffers& light() { return *light_; }
    const std::vector<PhaseTime>& phases() const { return phases_; }
    uint32_t invalidPatches() const { return invalid_; }
    /// Returns the lightmap of the last finished pass.
    FloatImage lightmap(LightmapDesc desc) const;
    /// Returns Solver::errors() as a grey image in lighting's unit; texels beside charts stay empty. Throws
    /// Error when there is nothing to tell yet.
    FloatImage errorMap() const;

    /// Returns what is wrong with the size where `limit` bytes may be taken, and which one fits; "" when it
    /// fits itself.
    static std::string sizeProblem(const vk::Device& device, const BakeSettings& settings, uint64_t triangles,
                                   uint64_t limit);
    /// Returns the device bytes that a bake of this size takes when every texel is covered.
    static uint64_t deviceBytes(const BakeSettings& settings, uint64_t triangles, bool software);

private:
    void makeTracers();
    void findInvalid();
    void onPhase(const char* phase, double done = -1.0) const;

    const vk::Device& device_;
    const Scene& scene_;
    BakeSettings settings_;
    PhaseHook phaseHook_;
    PatchSet patches_;
    std::unique_ptr<LightBuffers> light_;
    std::unique_ptr<SurfaceColours> colours_;
    std::unique_ptr<ObjectMover> mover_; // where layers are baked, whose solver follows edits
    std::unique_ptr<Tracer> tracer_;
    std::unique_ptr<Solver> solver_;
    std::string tracerChoice_;
    std::vector<PhaseTime> phases_;
    uint32_t invalid_ = 0;
};

} // namespace relume
