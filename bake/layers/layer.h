#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bake/gather/smoothing_width.h"
#include "bake/layers/light_groups.h"
#include "bake/vk/buffer.h"

namespace relume {

/// What decides a light's pattern: where it is and which form it has, but neither intensity nor colour, nor
/// what it is called. In a group these decide how its members are weighed.
struct LightPattern {
    LightKey::Kind kind = LightKey::Kind::Sky;
    uint32_t instance = 0, material = 0; // Emitter
    Light light;                         // Lamp: of no name and of white light of intensity 1
    float rotation = 0;                  // Sky [rad]
    std::string file;                    // Sky
    // Group: of those that shine, in the order of lightSources(), without what follows.
    std::vector<LightPattern> members;
    std::vector<glm::vec3> weights; // theirs
    uint64_t surfaces = 0;          // tells colours of surfaces apart
    uint64_t objects = 0;           // and where objects stand

    bool operator==(const LightPattern&) const = default;
};
LightPattern patternOf(const Scene& scene, const LightGroup& group);

/// How far a layer is: a pure function of the pattern, the geometry and the surfaces' colours.
struct LayerLevel {
    uint32_t directRounds = 0, linkRounds = 0;

    bool operator==(const LayerLevel&) const = default;
};

/// Part of a layer's direct light: a group of EmitterLight's or LampLight's.
struct DirectPart {
    bool emitters = false;
    uint32_t group = 0;
};

/// One light's share of the lightmap, for a unit of its weight, or a group's: direct light and all bounces.
struct Layer {
    LightPattern pattern;
    LightSource source;               // as it is now; weight: with its switches, 0 where it is off
    std::vector<LightSource> members; // of a group, likewise
    std::vector<DirectPart> parts;
    // vec4 per patch: lighting, variance of R, G and B together; it may be one with a layer of other
    // surfaces'.
    std::shared_ptr<vk::Buffer> direct; // nullptr: no rounds yet
    vk::Buffer result;                  // vec4 per patch: lighting, standard error; where there is a level
    uint32_t directRounds = 0;          // in direct
    // directRounds after each level that took more, the next one, too, once its direct light is there; what
    // is summed together decides the last bits.
    std::vector<uint32_t> directSteps;
    // Per part of a tile (TileParts) 1 where the first round's rays met the light's penumbra or the edge of
    // its shadow; patches elsewhere take each kPenumbraRounds-th round alone.
    std::vector<uint8_t> penumbra;
    // Per chunk kStale where direct is of objects that have moved since, kBeside where neighbours are: only
    // where these now are in a penumbra or are no longer it is made anew. Of kBegun ones the first of
    // directSteps is there again, kBesideBegun are these beside stale ones. Empty: nowhere.
    static constexpr uint8_t kStale = 1, kBeside = 2, kBegun = 3, kBesideBegun = 4;
    std::vector<uint8_t> stale;
    bool begun = false;          // all stale chunks are
    LayerLevel level;            // of result; no rounds: there is none yet
    SmoothingWidth width;        // of the last result
    double light = 0, count = 0; // sums over patches, R, G and B together
    double directVariance = 0, indirectVariance = 0, iterationError = 1;
    double error = 1;                // relRMSE of result
    std::optional<LayerLevel> redo;  // it had been here, with other surfaces, or before there was no memory
    std::vector<uint32_t> redoSteps; // its directSteps then; empty: redo is made in one
    bool converged = false;          // error below the aim, or all samples taken
    std::unique_ptr<Layer> before;   // shown until there is a result
    bool covered = false;            // LayerSolver's stand-in is shown in its place

    /// Of the patches, the share that takes a round of direct light, in the mean; 1 before the first.
    double directShare() const;
    /// Whether direct is still of where objects were, somewhere.
    bool isOutdated() const { return !stale.empty() && !begun; }
    /// Whether the next step of making direct anew is for the chunk, too.
    bool mends(size_t chunk) const { return stale[chunk] != 0 && (begun || stale[chunk] != kBegun); }
    bool has() const { return level.linkRounds > 0 || level.directRounds > 0; }
    /// What is to be seen of it: itself or the one before; nullptr: nothing.
    const Layer* shown() const { return has() ? this : before ? before->shown() : nullptr; }
};

/// What of the scene the layer does not show yet: "light 'Lamp' moved"; "": nothing.
std::string staleReason(const Layer& layer);

} // namespace relume
