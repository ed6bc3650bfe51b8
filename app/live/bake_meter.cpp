#include "app/live/bake_meter.h"

#include "app/live/layer_remark.h"
#include "app/live/light_balls.h"
#include "app/offline/layer_file.h"

#include <algorithm>

namespace relume {
namespace {

// Measuring is slower than telling progress, because it asks the device about rays and the driver about
// memory.
constexpr double kMeasureSeconds = 0.25;
// The convergence curve keeps so many points: more than a screen has columns.
constexpr size_t kMaxHistory = 4096;

// Returns the seconds until both errors that are asked for are reached; negative where that cannot be told.
double secondsLeft(const std::vector<ConvergencePoint>& history, const SolverSettings& settings) {
    const double whole = secondsUntil(history, settings.error);
    if (!(settings.localError > 0) || history.empty() || history.back().localError >= 1) return whole;
    const double local = secondsUntil(history, settings.localError, &ConvergencePoint::localError);
    return whole < 0 || local < 0 ? -1.0 : std::max(whole, local);
}

} // namespace

void addPoint(std::vector<ConvergencePoint>& history, const ConvergencePoint& point, size_t most) {
    if (point.error >= 1 || (!history.empty() && history.back().error == point.error)) return;
    history.push_back(point);
    if (history.size() <= most) return;
    for (size_t i = 0; 2 * i < history.size(); ++i)
        history[i] = history[2 * i];
    history.resize((history.size() + 1) / 2);
}

void BakeMeter::begin(BakeStatus& status) {
    status.progress = {};
    status.rays = 0;
    status.history.clear();
    status.raysPerSecond = 0;
    status.secondsLeft = -1;
    rays_.clear();
}

void BakeMeter::update(BakeStatus& status, Baker& baker, const BakeSettings& settings,
                       const vk::Device& device) {
    Solver& solver = baker.solver();
    const bool baking = status.phase == BakeStatus::Phase::Baking;
    if (!baking) status.rays = solver.raysSoFar(); // because nothing more will be measured
    const SolverProgress& now = solver.progress();
    status.progress = now;
    status.rays = std::max(status.rays, now.rays);
    const LayerSolver* layers = baker.layers();
    status.ballBytes = device.ledger().bytesOf(LightBalls::kOwner);
    status.stale = layers ? staleReasons(*layers) : std::vector<std::string>();
    status.groups = layers ? groupsOf(*layers) : std::vector<LightGroup>();
    addPoint(status.history, {now.seconds, now.error, now.localError95}, kMaxHistory);
    status.secondsLeft = baking ? secondsLeft(status.history, settings.solver) : -1.0;
    if (secondsSince(measured_) >= kMeasureSeconds) measure(status, solver, device);
}

void BakeMeter::measure(BakeStatus& status, Solver& solver, const vk::Device& device) {
    measured_ = Clock::now();
    status.rays = solver.raysSoFar();
    rays_.add(solver.progress().seconds, status.rays);
    status.raysPerSecond = rays_.perSecond();
    status.deviceBytes = device.usedMemory();
    status.bakeBytes = device.ledger().deviceBytes();
    status.hostBytes = device.ledger().bytes() - device.ledger().deviceBytes();
    status.validationMessages = device.validationMessages();
}

} // namespace relume
