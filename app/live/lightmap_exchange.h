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

/// The content of a published map's texels. Beside lighting this is the texture group and other quantities.
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
    Layer,    // the same as Light, but of a single light
    Seen,     // from the chosen patch: r 1 where it sees, g form factor over the largest one, b 1 at itself
};

/// The rows of a map in which blocks changed [texels]. There are none when first == end.
struct RowRange {
    uint32_t first = 0, end = 0;
    bool empty() const { return first >= end; }
    void add(const RowRange& other);
};

/// Describes a map that was written to a slot.
struct PublishedMap {
    uint32_t slot = 0;
    uint32_t set = 0; // of slots, see MapOffer::set
    MapContent content = MapContent::Light;
    LightKey light = {};     // of a content Layer: the light
    uint64_t bake = 0;       // number of the bake that it comes from, see LiveBake::start()
    bool complete = false;   // a solution with all bounces
    bool current = false;    // ... of the newest edit, as far as the solver tells them apart
    float unit = 1;          // [cd/m^2], [m], ...: a texel's 1.0
    glm::vec3 ambient{0.0f}; // mean of the patches, in the same unit as what a texel stands for
    float low = 0, high = 0; // range of the content's first channel, of all patches
    bool filled = true;      // so far around all charts that no filter meets an empty texel
    bool radiance = false;   // Light holds RTRad's radiosity: albedo and emission are in it
    RowRange changed = {};   // since the map before
};

/// The values of a light's layer at the texels of a ProbeRequest.
struct LayerProbe {
    uint64_t request = 0; // its number
    LightKey key;
    std::vector<glm::vec3> light; // lighting for a unit of its weight, 0 where no patch is
};

/// Offers three slots of one size: images of the bake thread that OpenGL imports, or plain memory.
struct MapOffer {
    uint32_t set = 0;  // counts from 1
    uint32_t size = 0; // edge [texels]; a texel is four 16-bit floats
    bool shared = false;
    std::array<int, 3> fds = {-1, -1, -1}; // shared: one per slot; the taker owns them
    uint64_t memorySize = 0;               // shared: [bytes] of each image's memory
};

/// A triple buffer that hands finished maps from the thread that bakes to the one that draws, without either
/// waiting for the other: one slot is shown, one may wait to be shown, and one is written. It knows neither
/// Vulkan nor OpenGL: a slot is written once its claim was granted, and read between take() and release().
class LightmapExchange {
public:
    static constexpr uint32_t kSlots = 3;

    ~LightmapExchange(); // closes what nobody took

    // The bake thread calls these functions.
    /// Replaces the set of slots; maps of the former one that were not taken are forgotten.
    void offer(const MapOffer& offer);
    /// Returns a slot to write, or nothing as long as the set was not accepted, a map still waits to be
    /// taken, or the drawing thread holds all the others.
    std::optional<uint32_t> claim();
    /// Returns the memory of a slot, where the set is not shared: size * size * 8 bytes.
    std::span<std::byte> memory(uint32_t slot);
    /// Says that the claimed slot is finished.
    void publish(const PublishedMap& map);
    /// Publishes a probe. It replaces one of the same light that was not taken.
    void publish(LayerProbe probe);
    /// Says that the claimed slot was not written after all.
    void giveUp(uint32_t slot);
    /// Tells whether the drawing thread has let go of all sets before this one.
    bool retiredBefore(uint32_t set) const;

    // The drawing thread calls these functions.
    /// Returns the newest offer, once. It is answered by accept() or refuse().
    std::optional<MapOffer> takeOffer();
    /// Accepts a set. Where it is not shared, `memory` has the memory of each slot, which must live until the
    /// set is retired.
    void accept(uint32_t set, const std::array<std::span<std::byte>, kSlots>& memory);
    /// Says that the images cannot be imported: the bake thread then offers plain memory.
    void refuse(uint32_t set);
    bool refused() const; // the bake thread asks this
    /// Returns the newest map, once. It stays readable until it is released.
    std::optional<PublishedMap> take();
    /// Returns the oldest probe that was not taken yet.
    std::optional<LayerProbe> takeProbe();
    bool hasProbe() const;
    /// Says that the drawing thread reads this slot no more.
    void release(uint32_t set, uint32_t slot);
    /// Says that the drawing thread has let go of all that belonged to the set.
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
