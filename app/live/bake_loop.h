#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/live/bake_desk.h"
#include "app/live/bake_meter.h"
#include "app/live/light_balls.h"
#include "app/live/map_publisher.h"
#include "app/live/scene_bake.h"
#include "assets/base/clock.h"

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
    void compileAhead();
    bool takeOrders(BakeOrders& orders);
    void obey(BakeOrders& orders);
    void prepare(BakeOrders::Start start);
    void showGlance();
    bool publishGlance();
    void goOnEdited(const BakeOrders::Start& start, uint64_t movesBefore);
    uint64_t texelMoves() const;
    void letGo();
    void reloadShaders();
    void reset();
    void beginMaps(KeptLight kept);
    void begin(bool goesOn = false);
    void ready();
    void onPhase(const char* phase, double done = -1.0);
    void steer(const BakeOrders& orders);
    bool steps() const;
    bool triesWaiting() const;
    void stepSolver();
    void logEnd();
    void applySeen();
    void inspectMore(const BakeOrders& orders);
    void takeExports(BakeOrders& orders);
    void exportAll();
    void refuseExports(const char* why);
    void endExports(BakeOrders& last);
    void publish();
    bool publishBalls();
    void endMaps();
    void fail(const std::string& message);
    void giveUp();
    void report(bool always);
    void wake();

    BakeDesk& desk_;
    BakeDeviceDesc desc_;
    std::unique_ptr<vk::Device> device_;
    std::unique_ptr<MapPublisher> maps_;
    std::optional<LightBalls> balls_;
    SceneBake bake_;
    std::optional<BakeOrders::Start> waiting_; // an edit that comes too early
    bool unlit_ = false; // a start that keeps no light was taken up, and no bake was made by it yet
    std::vector<BakeOrders::Export> exports_; // not written yet, as those of the next line
    std::vector<BakeOrders::EngineExport> engineExports_;
    BakeStatus status_; // report() copies it to the desk
    BakeOrders::Run run_ = BakeOrders::Run::Resume;
    std::vector<uint32_t> seenTiles_;
    InspectRequest inspect_;
    BakeMeter meter_;
    Clock::time_point reported_{};
};

} // namespace relume
