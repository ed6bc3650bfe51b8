#pragma once

#include <optional>
#include <vector>

#include "assets/lightmap_atlas.h"
#include "assets/scene_edits.h"
#include "bake/light_buffers.h"
#include "bake/object_move.h"
#include "bake/trace/tracer.h"

namespace relume {

/// Keeps patches, triangles and tracer with objects that are moved, hidden and shown again, without making
/// all of them anew: patches keep their indices. What it leaves is what a fresh bake would have made, but
/// that hidden objects keep their places among patches, as padding, and among triangles, shrunk to a point.
class ObjectMover {
public:
    /// What it works on; all must outlive it.
    struct On {
        const vk::Device& device;
        const Scene& scene;
        PatchSet& patches;
        LightBuffers& light;
    };
    /// Of how many directions each patch was told whether it lies inside something.
    static constexpr uint32_t kInsideSamples = 32;
    ObjectMover(const On& on, bool conservative);

    /// What these directions meet: links as markInvalid has them.
    void noteInside(const std::vector<uint32_t>& links);
    /// Objects stand as the scene has them now. Nothing: that cannot be followed (an object that was hidden
    /// from the beginning, triangles that have lost their area), and nothing has changed.
    std::optional<ObjectMove> follow(const LightmapAtlas& atlas, Tracer& tracer);
    /// Whether albedo or emission patterns of patches have changed in the last move.
    bool repainted() const { return repainted_; }
    uint32_t invalidPatches() const;

private:
    struct Moved {
        std::vector<uint32_t> shown, gone; // instances
    };
    struct Part; // of the scene, as new patches and triangles have it
    std::optional<Moved> moved() const;
    std::optional<Part> makePart(const Moved& moved, const LightmapAtlas& atlas) const;
    std::vector<shader::TraceBox> boxesOf(const Moved& moved) const;
    void putTriangles(Part& part, const Moved& moved);
    void putPatches(const Part& part, const Moved& moved, ObjectMove& move);
    void traceInside(Tracer& tracer, const ObjectMove& move);
    void findInside(Tracer& tracer, ObjectMove& move);
    void upload(const ObjectMove& changes) const;

    On on_;
    bool conservative_;
    bool repainted_ = false;
    std::vector<Placement> placed_;  // that patches are of
    std::vector<uint8_t> known_;     // per instance: it was there from the beginning
    std::vector<uint32_t> homes_;    // per texel: its patch when all are shown
    std::vector<glm::uvec2> inside_; // per patch: a bit for each direction that meets a back, the sky
};

} // namespace relume
