#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/live/lightmap_exchange.h"
#include "app/prepare.h"
#include "bake/baker.h"

namespace relume {

enum class DisplayMode { Auto, Shared, Copied };

/// What an OpenGL context can import: told to the bake thread, which decides.
struct DisplayHost {
    bool memoryObjects = false;                      // GL_EXT_memory_object_fd
    std::vector<std::array<uint8_t, 16>> deviceUuids; // GL_DEVICE_UUID_EXT
};

/// What is to be seen beside light, and how. Plain: main thread to bake thread.
struct InspectRequest {
    MapContent content = MapContent::Light;
    uint32_t mip = 0;   // of ligIn and ligOut, 0..4: means over 2^mip texels squared
    uint32_t texel = 0; // Seen: v * size + u of the chosen patch
    PairSettings preview; // Leaves, where the method has no quad-tree of its own
    bool operator==(const InspectRequest& other) const;
};

/// Light paths from a chosen patch, and voxels: what no map can hold.
struct InspectPaths {
    glm::vec3 from{0.0f};
    std::vector<glm::vec3> ends; // of the patch's links
};
struct InspectVoxels {
    float edge = 0; // [m]
    std::vector<glm::vec3> centres;
};

struct ConvergencePoint {
    double seconds = 0; // of solving
    double error = 1;   // remaining, relRMSE
};

/// Where the bake thread stands: a copy, taken once per frame.
struct BakeStatus {
    enum class Phase { Idle, Preparing, Baking, Paused, Done, Failed };
    Phase phase = Phase::Idle;
    std::string doing;       // Preparing: "tracer", ...; Failed: the error's one line
    double fraction = 0;     // of preparing
    uint64_t bake = 0;       // how many were started; this is the newest one's state
    BakeSettings settings;   // of it
    uint32_t patches = 0;
    SolverProgress progress;
    double raysPerSecond = 0; // over the last second or so
    double secondsLeft = -1;  // until the error that is asked for, by how it fell so far; negative: unknown
    std::vector<ConvergencePoint> history;
    std::string device, tracer, display; // what was chosen, with the reason
    uint64_t deviceBytes = 0;            // device memory in use, 0: unknown
    uint32_t validationMessages = 0;
};

/// One bake after the other on a thread and a device of its own. All calls return at once; they are for one
/// thread (the main one). The light of a former bake stays published until a new one has a first solution
/// with all its bounces.
class LiveBake {
public:
    struct Desc {
        std::string device; // as vk::Device::Desc::select
        bool validation = false;
        DisplayMode display = DisplayMode::Auto;
        DisplayHost host;
        double batchMs = 8; // aim of one batch
    };
    /// Starts the thread. Where Vulkan is missing the status says so (Failed).
    explicit LiveBake(const Desc& desc);
    ~LiveBake(); // stops; the Vulkan device goes with it: after OpenGL's context (picture_studio.h)
    LiveBake(const LiveBake&) = delete;
    LiveBake& operator=(const LiveBake&) = delete;

    /// Ends the thread, waiting for the batch under way.
    void stop();

    struct Start {
        const PreparedScene* scene = nullptr; // read by the thread until it holds it no more
        std::vector<Material> materials;      // instead of the scene's own
        BakeSettings settings;
        bool keepLight = false; // what is shown stays until this bake has a solution with all bounces
    };
    /// Bakes this from now on, in place of what was asked for before.
    void start(Start start);
    /// Whether the thread may still read a scene.
    bool holds(const PreparedScene& scene) const;
    void setBatchMs(double ms);
    void pause();
    void resume();
    void makePass();  // goes on until the pass (link methods: round) under way ends, then pauses
    void step();      // one batch, then pauses
    void abortPass(); // forgets the pass under way and pauses
    void reset();     // begins the same bake again from no light
    /// Tiles (8 x 8 texels, row by row) that the camera sees: they come first.
    void setSeenTiles(std::vector<uint32_t> tiles);
    void inspect(const InspectRequest& request);
    /// Voxels of this resolution; answered by takeVoxels().
    void askVoxels(uint32_t resolution);
    /// Writes the lightmap as it stands; the log tells how it went.
    void exportLightmap(const std::string& path, const LightmapDesc& desc);

    BakeStatus status() const;
    LightmapExchange& exchange() { return exchange_; }
    std::optional<InspectPaths> takePaths();
    std::optional<InspectVoxels> takeVoxels();
    /// Called from the bake thread whenever there is something new to see; must be harmless at any time.
    void setWake(std::function<void()> wake);
};

} // namespace relume
