#pragma once

#include <memory>

#include "app/live/bake_desk.h"
#include "app/live/bake_forecast.h"
#include "app/live/map_publisher.h"
#include "assets/base/clock.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// The work of the bake thread: it follows commands, steps the solver batch by batch and publishes its light.
class BakeLoop {
public:
    BakeLoop(BakeDesk& desk, const BakeDeviceDesc& desc);
    ~BakeLoop(); // from any thread, once run() has returned
    BakeLoop(const BakeLoop&) = delete;
    BakeLoop& operator=(const BakeLoop&) = delete;

    /// Runs until it is told to quit. Never throws: the status tells what goes wrong.
    void run();

private:
    using Phase = BakeStatus::Phase;
    void openDevice();
    bool takeOrders(BakeOrders& orders);
    void obey(BakeOrders& orders);
    void prepare(const BakeOrders::Start& start);
    bool onlyEdits(const BakeOrders::Start& start) const;
    bool followEdit(const BakeOrders::Start& start);
    bool followObjects(const BakeOrders::Start& start);
    LayerSolver* layered() const;
    void makeBaker(WorldMesh mesh, bool keepLight);
    void reloadShaders();
    void restart(bool keepLight);
    void beginMaps(bool keepLight);
    void begin();
    void ready();
    void onPhase(const char* phase, double done = -1.0);
    void steer(const BakeOrders& orders);
    void stepSolver();
    void logEnd();
    void applySeen();
    void inspectMore(const BakeOrders& orders);
    void exportAll(const BakeOrders& orders);
    void publish();
    void fail(const std::string& message);
    void measure();
    void follow();
    void report(bool always);
    void wake();

    BakeDesk& desk_;
    BakeDeviceDesc desc_;
    std::unique_ptr<vk::Device> device_;
    std::unique_ptr<MapPublisher> maps_;
    Scene scene_;                              // with the edits
    const PreparedScene* prepared_ = nullptr;  // scene_ was made from it; only its address counts
    std::optional<BakeOrders::Start> waiting_; // an edit that comes too early
    BakeSettings settings_;
    bool wantsLayers_ = true;      // layers are asked for, even if settings_ cannot have them
    uint32_t rings_ = 4;           // of texels filled around charts, on screen
    std::unique_ptr<Baker> baker_; // of scene_
    BakeStatus status_;            // report() copies it to the desk
    BakeOrders::Run run_ = BakeOrders::Run::Resume;
    std::vector<uint32_t> seenTiles_;
    InspectRequest inspect_;
    RayMeter meter_;
    Clock::time_point reported_{}, measured_{};
};

} // namespace relume
