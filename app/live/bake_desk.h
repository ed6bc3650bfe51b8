#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/edit/prepare.h"
#include "app/export/export_folder.h"
#include "app/export/web/web_page.h"
#include "app/live/lightmap_exchange.h"
#include "app/live/lit_ball.h"
#include "assets/model/scene_edits.h"
#include "bake/baker/baker.h"
#include "bake/baker/fitting_size.h"
#include "bake/layers/light_groups.h"

namespace relume {

enum class DisplayMode { Auto, Shared, Copied };

/// The ways in which an OpenGL context can import images. The bake thread is told, and decides by it.
struct DisplayHost {
    bool memoryObjects = false;                       // GL_EXT_memory_object_fd
    std::vector<std::array<uint8_t, 16>> deviceUuids; // GL_DEVICE_UUID_EXT
};

/// As the name of a device: a GPU that is not the one by which OpenGL draws.
constexpr const char* kSecondGpu = "second";

/// The device that a live bake runs on, and how its maps reach the display.
struct BakeDeviceDesc {
    std::string device = {};   // the same as vk::Device::Desc::select, or kSecondGpu
    uint64_t deviceMemory = 0; // as vk::Device::Desc::memoryLimit
    bool validation = false;
    DisplayMode display = DisplayMode::Auto;
    DisplayHost host = {};
    double batchMs = 8; // how long one batch should take [ms]
};

/// The request of the viewer for what to see beside light, and how. It is plain data that the main thread
/// hands to the bake thread.
struct InspectRequest {
    MapContent content = MapContent::Light;
    uint32_t mip = 0;          // of ligIn and ligOut, 0..4: means over 2^mip texels squared
    uint32_t texel = 0;        // Seen: v * size + u of the chosen patch
    PairSettings preview = {}; // Leaves, where the method has no quad-tree of its own
    LightKey light = {};       // Layer: which one ...
    glm::vec3 weight{0.0f};    // ... and what its light for a unit is multiplied with
    bool operator==(const InspectRequest& other) const;
};

/// Texels at which the bake thread reads each light's layer. It tells the values through the exchange, now
/// and whenever the layer changes.
struct ProbeRequest {
    uint64_t number = 0;          // the answers bear it
    std::vector<uint32_t> texels; // v * size + u, shader::kNoPatch: nothing; empty: no more
};

/// The light paths from a chosen patch. No map can hold these, nor the voxels below.
struct InspectPaths {
    glm::vec3 from{0.0f};
    std::vector<glm::vec3> ends; // of the patch's links
};
struct InspectVoxels {
    glm::vec3 edge{0.0f}; // [m], of each
    std::vector<glm::vec3> centres;
};

struct ConvergencePoint {
    double seconds = 0;    // of solving
    double error = 1;      // remaining, relRMSE
    double localError = 1; // SolverCounters::localError95
};

/// Tells how far the bake thread is. The main thread takes a copy once per frame.
struct BakeStatus {
    enum class Phase { Idle, Preparing, Baking, Paused, Done, Failed };
    Phase phase = Phase::Idle;
    std::string doing;     // Preparing: "tracer", ...; Failed: the error's one line
    double fraction = 0;   // of preparing
    uint64_t bake = 0;     // number of the bake that this tells of, see LiveBake::start()
    BakeSettings settings; // of that bake
    uint32_t patches = 0;
    bool layered = false;           // each light has a layer ...
    std::vector<LightGroup> groups; // ... but the members of each of these groups share one
    std::string remark;             // why there are no layers though asked for, and the remedy; "": nothing
    std::vector<std::string> stale; // the edits that the light does not show yet, one line each
    SolverProgress progress;
    uint64_t beginnings = 0;  // how often a bake began from no light, by start() or by reset()
    uint64_t rays = 0;        // since then, with those of the pass under way
    double raysPerSecond = 0; // over the last second or so
    double secondsLeft = -1;  // until the error asked for, judged by how it fell so far; negative: unknown
    std::vector<ConvergencePoint> history;
    std::string device, tracer, display; // what was chosen, with the reason
    uint64_t deviceBytes = 0;            // device memory in use, by all programs, 0: unknown
    uint64_t bakeBytes = 0;              // of it, by this bake
    uint64_t hostBytes = 0;              // of the machine's memory, which the device reads and writes
    uint64_t ballBytes = 0;              // of these, what lights the ball and the grid of probes
    uint32_t validationMessages = 0;
};

const char* phaseName(BakeStatus::Phase phase); // "baking"

/// The commands that a user gave since the bake thread looked last. The newest of each kind counts; all
/// exports do.
struct BakeOrders {
    enum class Run { Keep, Resume, Pause, Pass, Step };
    struct Start {
        const PreparedScene* scene = nullptr; // the thread reads it as long as LiveBake::holds() says
        SceneEdits edits;                     // of the scene
        LightMix mix = {};
        BakeSettings settings;
        bool keepLight = false; // what is shown stays until this bake has a solution with all bounces
        uint32_t rings = 4;     // of texels filled around charts, on screen
        uint64_t number = 0;    // counts the bakes that were asked for
        // Scenes with the same number have the same patches where their edits are the same. It is above 0.
        uint64_t surfaces = 1;
        // Among these, scenes with the same number have materials of the same textures, metallic and
        // roughness.
        uint64_t paint = 1;
    };
    struct Export {
        std::string path; // .exr or .png
        LightmapDesc lightmap;
        std::string scene;     // the file that it names as its scene's
        uint64_t surfaces = 1; // of the scene, as in Start
    };
    struct EngineExport {
        ExportDesc desc;
        std::optional<WebDesc> web = {}; // a page with the mix board is wanted instead
        std::string scene;               // the file that it names as its scene's
        uint64_t surfaces = 1;           // of the scene, as in Start
        std::vector<Material> materials; // of the scene, as it is shown
        glm::vec3 sky{0.0f};             // its radiance, or the factor of its picture, as it is shown

        const std::string& path() const { return web ? web->path : desc.folder; } // of what is written
    };
    std::optional<Start> start;
    bool reset = false, abort = false, reload = false;
    Run run = Run::Keep;
    std::optional<double> batchMs;
    std::optional<std::vector<uint32_t>> seenTiles;
    std::optional<InspectRequest> inspect;
    std::optional<ProbeRequest> probes;
    std::optional<BallRequest> balls;
    std::optional<uint32_t> voxels; // resolution
    std::vector<Export> exports;
    std::vector<EngineExport> engineExports;
    bool quit = false;
};

/// The state that both threads share.
struct BakeDesk {
    mutable std::mutex mutex; // guards all below but the exchange, which has its own
    std::condition_variable news;
    BakeOrders orders;
    BakeStatus status;
    std::optional<InspectPaths> paths;
    std::optional<InspectVoxels> voxels;
    std::optional<LitBalls> balls;
    std::function<void()> wake;
    const PreparedScene* held = nullptr; // the bake thread may still read it
    LightmapExchange exchange;
    // It tells what the device has to give before any bake; nothing where there is no device.
    std::promise<std::optional<BakeRoom>> room;
};

} // namespace relume
