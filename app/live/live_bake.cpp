#include "app/live/live_bake.h"

#include "app/live/bake_loop.h"

#include <utility>

namespace relume {

LiveBake::LiveBake(const Desc& desc)
    : desk_(std::make_unique<BakeDesk>()), room_(desk_->room.get_future().share()),
      loop_(std::make_unique<BakeLoop>(*desk_, desc)), thread_([this] { loop_->run(); }) {}

LiveBake::~LiveBake() {
    stop();
}

void LiveBake::stop() {
    if (!thread_.joinable()) return;
    order([](BakeOrders& orders) { orders.quit = true; });
    thread_.join();
}

template<typename Change>
void LiveBake::order(Change change) {
    {
        const std::lock_guard lock(desk_->mutex);
        change(desk_->orders);
    }
    desk_->news.notify_one();
}

uint64_t LiveBake::start(Start start) {
    start.number = ++bakes_;
    order([&](BakeOrders& orders) {
        // This start keeps no light where the last one kept none and was not taken up yet.
        if (orders.start && !orders.start->keepLight) start.keepLight = false;
        orders.start = std::move(start);
        orders.reset = orders.abort = orders.reload = false;
        if (orders.run != BakeOrders::Run::Pause) orders.run = BakeOrders::Run::Resume;
    });
    return bakes_;
}

bool LiveBake::holds(const PreparedScene& scene) const {
    const std::lock_guard lock(desk_->mutex);
    const std::optional<Start>& next = desk_->orders.start;
    return desk_->held == &scene || (next && next->scene == &scene);
}

void LiveBake::setBatchMs(double ms) {
    order([&](BakeOrders& orders) { orders.batchMs = ms; });
}

void LiveBake::run(BakeOrders::Run run) {
    order([&](BakeOrders& orders) { orders.run = run; });
}

void LiveBake::abortPass() {
    order([](BakeOrders& orders) {
        orders.abort = true;
        orders.run = BakeOrders::Run::Pause;
    });
}

void LiveBake::reset() {
    order([](BakeOrders& orders) { orders.reset = true; });
}

void LiveBake::reloadShaders() {
    order([](BakeOrders& orders) { orders.reload = true; });
}

void LiveBake::setSeenTiles(std::vector<uint32_t> tiles) {
    order([&](BakeOrders& orders) { orders.seenTiles = std::move(tiles); });
}

void LiveBake::inspect(const InspectRequest& request) {
    order([&](BakeOrders& orders) { orders.inspect = request; });
}

void LiveBake::askVoxels(uint32_t resolution) {
    order([&](BakeOrders& orders) { orders.voxels = resolution; });
}

void LiveBake::askProbes(ProbeRequest request) {
    order([&](BakeOrders& orders) { orders.probes = std::move(request); });
}

void LiveBake::askBalls(BallRequest request) {
    order([&](BakeOrders& orders) { orders.balls = std::move(request); });
}

void LiveBake::exportLightmap(BakeOrders::Export wanted) {
    order([&](BakeOrders& orders) { orders.exports.push_back(std::move(wanted)); });
}

void LiveBake::exportForEngine(BakeOrders::EngineExport wanted) {
    order([&](BakeOrders& orders) { orders.engineExports.push_back(std::move(wanted)); });
}

BakeStatus LiveBake::status() const {
    const std::lock_guard lock(desk_->mutex);
    return desk_->status;
}

std::optional<InspectPaths> LiveBake::takePaths() {
    const std::lock_guard lock(desk_->mutex);
    return std::exchange(desk_->paths, std::nullopt);
}

std::optional<InspectVoxels> LiveBake::takeVoxels() {
    const std::lock_guard lock(desk_->mutex);
    return std::exchange(desk_->voxels, std::nullopt);
}

std::optional<LitBalls> LiveBake::takeBalls() {
    const std::lock_guard lock(desk_->mutex);
    return std::exchange(desk_->balls, std::nullopt);
}

void LiveBake::setWake(std::function<void()> wake) {
    const std::lock_guard lock(desk_->mutex);
    desk_->wake = std::move(wake);
}

void LiveBake::wake() const {
    std::function<void()> wake;
    {
        const std::lock_guard lock(desk_->mutex);
        wake = desk_->wake;
    }
    if (wake) wake();
}

} // namespace relume
