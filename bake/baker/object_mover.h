#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/model/scene_edits.h"
#include "bake/validity/met_bits.h"
#include "bake/layers/object_move.h"
#include "bake/surface/cit_pass.h"
#include "bake/surface/light_buffers.h"
#include "bake/surface/object_members.h"
#include "bake/surface/patch_carry.h"
#include "bake/trace/tracer.h"

namespace relume {

struct CoverSearch;
class CoverSearcher;
class MoveSearch;

/// Keeps patches, triangles and tracer with objects that are moved, hidden and shown again, without making
/// all of them anew: patches keep their indices. What it leaves is what a fresh bake would have made, but
/// that hidden objects keep their places among patches, as padding, and among triangles, shrunk to a point.
class ObjectMover {
public:
    /// The things that it works on; all must outlive it.
    struct On {
        const vk::Device& device;
        const Scene& scene;
        PatchSet& patches;
        LightBuffers& light;
    };
    ObjectMover(const On& on, bool conservative);
    ~ObjectMover();

    /// Takes over what directions of patches meet, as findInside tells it, and how many patches lie inside
    /// something.
    void noteInside(std::vector<MetBits> met, uint32_t patches);
    /// Holds what a mover leaves for one of the same level, whose objects were edited.
    struct FormerSurfaces {
        const PatchSet& patches;
        size_t instances = 0;               // of its scene
        const std::vector<MetBits>& inside; // as giveInside() has it
        const std::vector<OwnPoint>& aside; // where patches had stepped aside to
    };
    std::vector<MetBits> giveInside() { return std::move(inside_); }
    /// Goes on from a former mover in place of noteInside(): patches that were there have what it knew of
    /// them (carrySearches() was done). Returns what is other than before, as of objects that have moved.
    ObjectMove takeOver(const FormerSurfaces& former, const PatchCarry& carry, Tracer& tracer);
    /// Follows objects to where the scene has them now. Returns nothing where that cannot be followed (an
    /// object that was hidden from the beginning, triangles that have lost their area); then nothing has
    /// changed.
    std::optional<ObjectMove> follow(const LightmapAtlas& atlas, Tracer& tracer);
    /// Gives patches of these instances (ascending) the albedo patterns that the scene's materials and
    /// textures make now; hidden ones get theirs when they are shown. Returns false where it cannot tell
    /// them, as for an object that was hidden from the beginning; then nothing has changed.
    bool repaint(const LightmapAtlas& atlas, std::span<const uint32_t> instances);
    /// Tells whether albedo or emission patterns of patches have changed in the last move.
    bool repainted() const { return repainted_; }
    /// Returns the patches that may lie upon a surface (mayTouch), ascending.
    std::vector<uint32_t> touching() const;
    /// Returns how many patches lie inside something, those that step aside, too.
    uint32_t insidePatches() const { return insidePatches_; }

private:
    struct Moved {
        std::vector<uint32_t> shown, gone; // instances
    };
    struct Part; // part of the scene, as new patches and triangles have it
    std::optional<Moved> moved() const;
    std::optional<Part> makePart(const Moved& moved, const LightmapAtlas& atlas);
    TextureGroup rasterize(const WorldMesh& mesh, const TexelWindow& window);
    TexelWindow windowOf(const std::vector<uint32_t>& slots) const;
    std::vector<shader::TraceBox> boxesOf(const Moved& moved) const;
    MoveSearch& searchFor(Tracer& tracer);
    void putTriangles(const Part& part);
    void putUvs(const Part& part);
    std::vector<uint32_t> putPatches(const Part& part, ObjectMove& move);
    std::vector<uint32_t> traceInside(Tracer& tracer, const ObjectMove& move);
    std::vector<uint32_t> findInside(Tracer& tracer, const std::vector<uint32_t>& patches, ObjectMove& move);
    CoverSearch coverSearch(Tracer& tracer) const;
    bool isNear(uint32_t patch, const ObjectMove& move) const;
    void findCovers(CoverSearcher& covers, const std::vector<uint32_t>& slots, ObjectMove& move);
    std::vector<uint32_t> stepAside(Tracer& tracer, const std::vector<OwnPoint>& before, ObjectMove& move);
    ObjectMove searched(Tracer& tracer, const std::vector<uint32_t>& slots,
                        const std::vector<OwnPoint>& before, ObjectMove& move);
    void upload(const std::vector<uint32_t>& slots, const ObjectMove& move) const;

    On on_;
    bool conservative_;
    bool repainted_ = false;
    uint32_t insidePatches_ = 0;
    std::vector<Placement> placed_;      // where the patches' instances stand
    std::vector<uint8_t> known_;         // per instance: it was there from the beginning
    ObjectMembers triangles_, slots_;    // slots: places among patches
    std::vector<uint32_t> texels_;       // per patch: its texel and kHome when all are shown
    std::vector<MetBits> inside_;        // per patch
    std::unique_ptr<MoveSearch> search_; // once something moves
    std::unique_ptr<CitPass> cit_;       // of what moved last
};

} // namespace relume
