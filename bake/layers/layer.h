#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bake/gather/smoothing_width.h"
#include "bake/layers/error_sketch.h"
#include "bake/layers/light_groups.h"
#include "bake/vk/buffer.h"

namespace relume {

/// The cache key of a light's layer: it says where the light is and which form it has, but neither intensity,
/// nor colour, nor name. In a group, intensity and colour decide how its members are weighed.
struct LightCacheKey {
    LightKey::Kind kind = LightKey::Kind::Sky;
    uint32_t instance = 0, material = 0; // Emitter
    Light light;                         // Lamp: without name, white, of intensity 1
    float rotation = 0;                  // Sky [rad]
    std::string file;                    // Sky
    // A group lists the members that shine, in the order of lightSources(), without the fields that follow.
    std::vector<LightCacheKey> members;
    std::vector<glm::vec3> weights; // of these members
    uint64_t surfaces = 0;          // SceneState of the surfaces' base colours
    uint64_t objects = 0;           // SceneState of where objects stand

    bool operator==(const LightCacheKey&) const = default;
};
LightCacheKey cacheKeyOf(const Scene& scene, const LightGroup& group);

/// A level tells how far a layer is. The layer at a level is a pure function of the cache key, the geometry
/// and the surfaces' colours.
struct LayerLevel {
    uint32_t directSamplePasses = 0, linkSamplePasses = 0;

    bool operator==(const LayerLevel&) const = default;
};

/// Returns the sample pass before which a step of direct light ends that begins with this one, unless its
/// level ends it: these steps are the same whatever levels a layer goes through, and so are the sums' last
/// bits.
uint32_t nextDirectStep(uint32_t samplePasses);

/// Part of a layer's direct light: a group of EmitterLight or of LampLight.
struct DirectPart {
    bool emitters = false;
    uint32_t group = 0;
    uint32_t rays = 0;  // per patch and sample pass; 0: nothing in it shines
    bool picks = false; // each ray goes to one of many polygons, which is picked
};

/// Tells how far a layer is to go. It follows from all layers and their weights as they are now
/// (LayerSchedule::apportion).
struct LayerPlan {
    LayerLevel wanted;      // the level to be made next, where it has one and goes on
    bool converged = false; // it needs no further level
    bool hasty = false;     // its bounces were in haste, and dark places lack light
    double directFall = 1;  // how direct light's variance falls, by its last levels: SampledPart::fall
};

/// One light's share of the lightmap for a unit of its weight, or a group's share: direct light and all
/// bounces.
struct Layer {
    LightCacheKey cacheKey;
    LightSource source;               // as it is now; weight: with its switches, 0 where it is off
    std::vector<LightSource> members; // of a group, likewise
    std::vector<DirectPart> parts;
    // A vec4 per patch holds lighting and the variance of R, G and B together. The buffer may be shared with
    // a layer of the same light under other surfaces.
    std::shared_ptr<vk::Buffer> direct; // nullptr: no sample passes yet
    vk::Buffer result;                  // vec4 per patch: lighting, standard error; where there is a level
    uint32_t directSamplePasses = 0;    // sample passes in direct
    // These are directSamplePasses after each level that took more, and of the next level once its direct
    // light is there. What is summed together decides the last bits.
    std::vector<uint32_t> directSteps;
    // There is a 1 for each part of a tile (TileParts) in which rays of the first sample pass met the light's
    // penumbra or the edge of its shadow. Patches elsewhere take only every kPenumbraSamplePasses-th sample
    // pass.
    std::vector<uint8_t> penumbra;
    // A chunk is kDirty where direct is of objects that have moved since, and kBeside where its neighbours
    // are: it is made anew only where these now are in a penumbra or are no longer. In kBegun chunks the
    // first of directSteps is there again; kBesideBegun ones are these beside dirty chunks. Empty stands for
    // nowhere.
    static constexpr uint8_t kDirty = 1, kBeside = 2, kBegun = 3, kBesideBegun = 4;
    std::vector<uint8_t> dirty;
    bool begun = false;          // all dirty chunks have begun
    LayerLevel level;            // of result; no sample passes: there is none yet
    SmoothingWidth width;        // of the last result
    double light = 0, count = 0; // sums over patches, R, G and B together
    double directVariance = 0, indirectVariance = 0, iterationError = 1;
    ErrorSketch sketch;              // of the indirect light's error; empty: not known
    double error = 1;                // relRMSE of result
    std::optional<LayerLevel> redo;  // the level it had with other surfaces, or before memory was short
    std::vector<uint32_t> redoSteps; // its directSteps then; empty: redo is made in one
    LayerPlan plan;
    std::unique_ptr<Layer> before; // shown until there is a result
    bool covered = false;          // LayerMixer's stand-in is shown in its place

    /// Returns the share of the patches that takes a sample pass of direct light, in the mean; 1 before the
    /// first one.
    double directShare() const;
    /// Returns the rays per patch and sample pass of its direct light; 0: nothing in it shines.
    uint32_t rays() const;
    /// Returns the same where each ray to a polygon that is picked counts as so many.
    double raysWeighed(double picked) const;
    /// Tells whether it adds to the picture: its weight is not 0.
    bool shines() const { return source.weight != glm::vec3(0.0f); }
    bool isGroup() const { return source.key.kind == LightKey::Kind::Group; }
    /// Tells whether direct is somewhere still of where objects were.
    bool isOutdated() const { return !dirty.empty() && !begun; }
    /// Tells whether the next step of repairing direct light takes the chunk, too.
    bool repairs(size_t chunk) const { return dirty[chunk] != 0 && (begun || dirty[chunk] != kBegun); }
    bool has() const { return level.linkSamplePasses > 0 || level.directSamplePasses > 0; }
    /// Returns what is to be seen of it: the layer itself or the one before; nullptr for nothing.
    const Layer* shown() const { return has() ? this : before ? before->shown() : nullptr; }
};

/// Tells whether each of these layers that shines has some direct light.
bool allLit(const std::vector<std::unique_ptr<Layer>>& layers);

/// Tells what of the scene the layer does not show yet, as "light 'Lamp' moved"; returns "" for nothing.
std::string staleReason(const Layer& layer);

} // namespace relume
