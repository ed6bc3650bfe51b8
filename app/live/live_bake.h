#pragma once

#include "app/live/bake_desk.h"

#include <memory>
#include <thread>

namespace relume {

class BakeLoop;

/// Runs one bake after the other on a thread and a device of its own. All calls but stop() and room() return
/// at once; one thread (the main one) makes them. The light of a former bake stays published until a new one
/// has a first solution with all its bounces.
class LiveBake {
public:
    using Desc = BakeDeviceDesc;
    /// Starts the thread. Where Vulkan is missing, the status says so (Failed).
    explicit LiveBake(const Desc& desc);
    ~LiveBake(); // stops and destroys the Vulkan device: only after OpenGL's context (picture_studio.h)
    LiveBake(const LiveBake&) = delete;
    LiveBake& operator=(const LiveBake&) = delete;

    /// Ends the thread, waiting for the batch under way; the Vulkan device stays.
    void stop();

    using Start = BakeOrders::Start;
    /// Returns what the device has to give while nothing is baked, and waits until it is there; nothing where
    /// there is none. For any thread.
    std::optional<BakeRoom> room() const { return room_.get(); }
    /// Bakes `start` from now on, in place of what was asked for before. Returns the bake's number, which
    /// status and maps bear.
    uint64_t start(Start start);
    /// Tells whether the thread may still read a scene.
    bool holds(const PreparedScene& scene) const;
    void setBatchMs(double ms);
    void pause() { run(BakeOrders::Run::Pause); }
    void resume() { run(BakeOrders::Run::Resume); }
    /// Goes on until the bounce (in link methods the sample pass) under way ends, then pauses.
    void makePass() { run(BakeOrders::Run::Pass); }
    void step() { run(BakeOrders::Run::Step); } // one batch, then pauses
    void abortPass();                           // forgets the pass under way and pauses
    void reset();                               // begins the same bake again from no light
    /// Begins again with the kernels as --shaders' folder has them now. Where one does not compile, the log
    /// says so and all goes on as it was.
    void reloadShaders();
    /// Sets the tiles (8 x 8 texels, row by row) that the camera sees: they come first.
    void setSeenTiles(std::vector<uint32_t> tiles);
    void inspect(const InspectRequest& request);
    /// Asks for the voxels of this resolution; takeVoxels() answers.
    void askVoxels(uint32_t resolution);
    /// Asks for layers at texels; exchange().takeProbe() answers, where each light has a layer.
    void askProbes(ProbeRequest request);
    /// Asks for the light at places, now and whenever it changes; takeBalls() answers.
    void askBalls(BallRequest request);
    /// Writes the lightmap as it stands; the log tells how it went.
    void exportLightmap(BakeOrders::Export wanted);
    /// Writes the level with its lightmap as it stands, as an engine reads it; the log tells how it went.
    void exportForEngine(BakeOrders::EngineExport wanted);

    BakeStatus status() const;
    LightmapExchange& exchange() { return desk_->exchange; }
    std::optional<InspectPaths> takePaths();
    std::optional<InspectVoxels> takeVoxels();
    std::optional<LitBalls> takeBalls();
    /// Sets what the bake thread calls whenever there is something new to see. It must be harmless at any
    /// time.
    void setWake(std::function<void()> wake);
    /// Calls it, from any thread.
    void wake() const;

private:
    template<typename Change>
    void order(Change change);
    void run(BakeOrders::Run run);

    uint64_t bakes_ = 0;
    std::unique_ptr<BakeDesk> desk_;
    std::shared_future<std::optional<BakeRoom>> room_;
    std::unique_ptr<BakeLoop> loop_; // has the device, which outlives the thread
    std::thread thread_;
};

} // namespace relume
