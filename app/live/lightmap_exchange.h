#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "bake/lights/light_source.h"

namespace relume {

/// What the texels of a published map hold; beside lighting the texture group and other things one looks at.
enum class MapContent : uint32_t {
    Light,    // lighting, irradiance / pi, smoothed as for output
    LigIn,    // lighting as the last bounce read it
    LigOut,   // what the bounce under way has gathered so far
    Position, // [m], world space
    Normal,   // unit
    Material, // albedo
    Area,     // r: [m^2] of a patch
    Leaves,   // quad-tree: r log2 of a leaf's edge [texels], g 1 along its border, b in [0, 1) tells leaves
              // apart
    Error,    // r: how far the light may still be off, in lighting's unit
    Layer,    // as Light, of one of the lights alone
    Seen, // from the chosen patch: r 1 where it sees, g that one's form factor over the largest, b 1 itself
};

/// Rows of blocks of a map that changed [texels]; first == end: none.
struct RowRange {
    uint32_t first = 0, end = 0;
    bool empty() const { return first >= end; }
    void add(const RowRange& other);
};

/// A map that was written to a slot.
struct PublishedMap {
    uint32_t slot = 0;
    uint32_t set = 0; // of slots, as MapOffer has it
    MapContent content = MapContent::Light;
    uint64_t bake = 0;       // number of the bake that it comes from, see LiveBake::start()
    bool complete = false;   // a solution with all bounces
    float unit = 1;          // [cd/m^2], [m], ...: a texel's 1.0
    glm::vec3 ambient{0.0f}; // mean of the patches, in the same unit as what a texel stands for
    float low = 0, high = 0; // range of the content's first channel, of all patches
    bool filled = true;      // all around charts so far that no filter meets an empty texel
    bool radiance = false;   // Light holds RTRad's radiosity: albedo and emission are in it
    RowRange changed = {};   // since the map before
};

/// What a light's layer holds at the texels of a ProbeRequest.
struct LayerProbe {
    uint64_t request = 0; // its number
    LightKey key;
    std::vector<glm::vec3> light; // lighting for a unit of its weight, 0 where no patch is
};

/// Three slots of one size that the bake thread wants: images of its own to be imported, or plain memory.
struct MapOffer {
    uint32_t set = 0;  // counts from 1
    uint32_t size = 0; // edge [texels]; a texel is four 16-bit floats
    bool shared = false;
    std::array<int, 3> fds = {-1, -1, -1}; // shared: one per slot; the taker owns them
    uint64_t memorySize = 0;               // shared: [bytes] of each image's memory
};

/// Hands finished maps from the thread that bakes to the one that draws, without either waiting for the
/// other: of three slots one is shown, one may wait to be shown, and one is written. Knows neither Vulkan nor
/// OpenGL: a slot is written once its claim was granted, and read between take() and release().
class LightmapExchange {
public:
    static constexpr uint32_t kSlots = 3;

    ~LightmapExchange(); // closes what nobody took

    // The bake thread's side.
    /// Replaces the set of slots; maps of the former one that were not taken are forgotten.
    void offer(const MapOffer& offer);
    /// A slot to write; none as long as the set was not accepted, a map still waits to be taken, or the
    /// drawing thread holds all the others.
    std::optional<uint32_t> claim();
    /// Memory of a slot, where the set is not shared: size * size * 8 bytes.
    std::span<std::byte> memory(uint32_t slot);
    /// The claimed slot is finished.
    void publish(const PublishedMap& map);
    /// Replaces what was not taken of the same light.
    void publish(LayerProbe probe);
    /// The claimed slot was not written after all.
    void giveUp(uint32_t slot);
    /// Whether the drawing thread has let go of all sets before this one.
    bool retiredBefore(uint32_t set) const;

    // The drawing thread's side.
    /// A set that is wanted; to be answered by accept() or refuse().
    std::optional<MapOffer> takeOffer();
    /// memory: of each slot, where the set is not shared; it must live until the set is retired.
    void accept(uint32_t set, const std::array<std::span<std::byte>, kSlots>& memory);
    /// The images cannot be imported: the bake thread is to offer plain memory.
    void refuse(uint32_t set);
    bool refused() const; // the bake thread's question
    /// The newest map, once; it stays readable until it is released.
    std::optional<PublishedMap> take();
    /// The oldest probe, each once.
    std::optional<LayerProbe> takeProbe();
    bool hasProbe() const;
    /// The drawing thread reads this slot no more.
    void release(uint32_t set, uint32_t slot);
    /// The drawing thread has let go of all that belonged to the set.
    void retire(uint32_t set);

private:
    enum class State : uint8_t { Free, Written, Waiting, Shown };
    std::optional<uint32_t> find(State state) const;
    void closeOffer();

    mutable std::mutex mutex_;
    MapOffer offer_;
    bool offered_ = false, accepted_ = false, refused_ = false;
    uint32_t retired_ = 0; // all sets up to this one
    std::array<State, kSlots> states_{};
    std::array<std::span<std::byte>, kSlots> memory_{};
    PublishedMap waiting_;
    std::vector<LayerProbe> probes_; // the oldest first
};

} // namespace relume
