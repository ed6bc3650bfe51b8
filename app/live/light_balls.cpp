#include "app/live/light_balls.h"

#include "bake/layers/layer_solver.h"
#include "bake/probes/probe_grid.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace relume {
namespace {

// New light is told so often: no eye follows more, and the bake goes on in between.
constexpr double kBallSeconds = 0.1;
// So many rays go to each side of a ball that a user looks at closely, and of each in a grid.
constexpr uint32_t kBallSamples = 2048, kGridSamples = 64;
// A grid of a view has so many probes at most: more would hide each other, and take the bake's time.
constexpr double kMostOfView = 400;

bool sameLamps(const std::vector<shader::Lamp>& a, const std::vector<shader::Lamp>& b) {
    // Lamps have no padding (shaders/shared.h), and these all have colour 1.
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

bool sameSources(const std::vector<LightSource>& a, const std::vector<LightSource>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const LightSource& x, const LightSource& y) {
        return x.key == y.key && x.weight == y.weight;
    });
}

// A driver needs some of the memory that is free for itself.
constexpr double kMemoryShare = 0.9;

} // namespace

BallStep decideBalls(const BallFacts& facts) {
    if (!facts.wanted) return BallStep::None;
    if (!facts.traced) return BallStep::Trace;
    if (!facts.newer) return BallStep::None;
    return facts.secondsSince < kBallSeconds ? BallStep::Wait : BallStep::Gather;
}

std::string ballProblem(const BallMeans& means) {
    if (means.rtrad)
        return "RTRad's preset knows no light between surfaces: choose another method to light the ball and "
               "the probes";
    const auto mebibytes = [](uint64_t bytes) { return (bytes + (uint64_t{1} << 20) - 1) >> 20; };
    if (static_cast<double>(means.needed) <= kMemoryShare * static_cast<double>(means.free)) return "";
    return fmt::format("the ball and the probes need {} MiB of device memory, and {} are free: use a smaller "
                       "lightmap, or close other programs",
                       mebibytes(means.needed), means.free >> 20);
}

std::vector<glm::vec3> gridOfView(const Box& bounds) {
    if (bounds.empty()) return {};
    const glm::vec3 size = bounds.size();
    const float longest = std::max({size.x, size.y, size.z});
    if (!(longest > 0.0f)) return {};
    constexpr float kAlong = 8.0f, kStep = 1.05f;
    float spacing = longest / kAlong;
    const auto count = [&] {
        const glm::dvec3 n = glm::max(glm::floor(glm::dvec3(size) / double{spacing} * (1.0 + 1e-6)), 1.0);
        return n.x * n.y * n.z;
    };
    while (count() > kMostOfView)
        spacing *= kStep;
    return probePoints(planProbeGrid(bounds.low, bounds.high, spacing));
}

std::vector<LightSource> shiningSources(const Baker& baker, const Scene& scene) {
    if (baker.layers() == nullptr) return lightSources(scene);
    std::vector<LightSource> sources;
    for (const std::unique_ptr<Layer>& layer : baker.layers()->layers()) {
        if (!layer->shines()) continue;
        if (layer->members.empty())
            sources.push_back(layer->source);
        else
            sources.insert(sources.end(), layer->members.begin(), layer->members.end());
    }
    return sources;
}

void LightBalls::ask(BallRequest request) {
    if (!request.wanted()) forget(); // the memory is the bake's again
    request_ = std::move(request);
}

void LightBalls::forget() {
    tracer_.reset();
    ball_.reset();
    grid_.reset();
    tracedFor_ = {};
    told_ = owes_ = false;
    remark_.clear();
}

// Returns the device bytes that the next trace takes, 0 where it takes no more than there is.
uint64_t LightBalls::needed(const Bake& bake, size_t lamps) const {
    const size_t places = kProbeStride + request_.grid.size();
    if (tracer_ && places_ == places && moves_ == bake.baker.moves().seconds) return 0;
    const PatchSet& patches = bake.baker.patches();
    BakeSettings settings = bake.settings;
    settings.probes = {.count = static_cast<uint32_t>(places),
                       .samples = kBallSamples,
                       .targets = static_cast<uint32_t>(lamps) * kProbeLampSamples,
                       .lights = 1};
    const uint64_t size = patches.scene.size;
    return memoryNeeds(settings, extentOf(bake.scene, patches.scene.mesh),
                       {.chunkCount = patches.chunkCount(),
                        .texels = size * size,
                        .software = device_.info().software(),
                        .skyPixels = bake.scene.sky.pixels.size(),
                        .skyRows = bake.scene.sky.height})
        .probes;
}

std::optional<LitBalls> LightBalls::next(const Bake& bake) {
    owes_ = false;
    if (!request_.wanted()) return std::nullopt;
    const LampSet lamps = probeLamps(bake.scene, bake.baker.patches().scene.mesh);
    const std::vector<LightSource> sources = shiningSources(bake.baker, bake.scene);
    const bool newer = !told_ || version_ != bake.version || !sameSources(sources_, sources);
    const BallStep step = decideBalls(
        {.wanted = true, .traced = isTraced(bake, lamps), .newer = newer, .secondsSince = secondsSince(at_)});
    owes_ = step == BallStep::Wait;
    if (step == BallStep::None || step == BallStep::Wait) return std::nullopt;
    const std::string problem =
        ballProblem({.rtrad = bake.settings.solver.transport.rtrad,
                     .needed = step == BallStep::Trace ? needed(bake, lamps.lamps.size()) : 0,
                     .free = device_.freeMemory()});
    if (!problem.empty()) {
        if (std::exchange(remark_, problem) == problem) return std::nullopt;
        LitBalls none;
        none.remark = problem;
        return none;
    }
    remark_.clear();
    if (step == BallStep::Trace) trace(bake, lamps);
    LitBalls answer = gather(bake, sources);
    answer.traced = step == BallStep::Trace;
    sources_ = sources;
    version_ = bake.version;
    told_ = true;
    at_ = Clock::now();
    return answer;
}

bool LightBalls::isTraced(const Bake& bake, const LampSet& lamps) const {
    return tracer_ && tracedFor_ == request_ && moves_ == bake.baker.moves().seconds &&
           sameLamps(lamps_, lamps.lamps);
}

// The ball is probe 0, and the grid begins at the next stride: a ball that is dragged does not trace the
// grid.
void LightBalls::trace(const Bake& bake, const LampSet& lamps) {
    const bool sameScene =
        tracer_ && moves_ == bake.baker.moves().seconds && places_ == kProbeStride + request_.grid.size();
    if (!sameScene) {
        std::vector<glm::vec3> points(kProbeStride + request_.grid.size(), glm::vec3(0.0f));
        places_ = points.size();
        TracerKind kind = TracerKind::Auto;
        std::string why;
        if (!usesVoxels(bake.settings)) kind = parseTracerKind(bake.baker.tracer().name());
        if (kind == TracerKind::Auto) kind = chooseTracer(device_.info(), why);
        tracer_ =
            std::make_unique<ProbeTracer>(device_, bake.baker.patches(), lamps, std::move(points), kind);
    }
    const bool newLamps = !sameLamps(lamps_, lamps.lamps);
    if (newLamps) tracer_->setLamps(lamps);
    if (request_.ball) {
        tracer_->move(0, {*request_.ball});
        ball_ = tracer_->trace(0, 1, kBallSamples);
    } else {
        ball_.reset();
    }
    if (request_.grid.empty()) {
        grid_.reset();
    } else if (!sameScene || newLamps || tracedFor_.grid != request_.grid) {
        tracer_->move(kProbeStride, request_.grid);
        grid_ = tracer_->trace(kProbeStride, static_cast<uint32_t>(request_.grid.size()), kGridSamples);
    }
    tracedFor_ = request_;
    lamps_ = lamps.lamps;
    moves_ = bake.baker.moves().seconds;
}

LitBalls LightBalls::gather(const Bake& bake, const std::vector<LightSource>& sources) const {
    const ProbeLight light = probeLight(bake.scene, bake.baker.patches(), sources, bake.light(),
                                        bake.settings.solver.transport.reflectivity);
    LitBalls balls;
    if (ball_) balls.ball = lit(*ball_, light).at(0);
    if (grid_) balls.grid = lit(*grid_, light);
    return balls;
}

std::vector<LitBall> LightBalls::lit(const ProbeLinks& links, const ProbeLight& light) const {
    const std::vector<Harmonics> radiance = gatherProbes(device_.workers(), links, {&light, 1}).at(0);
    const std::vector<double> backs = probeBacks(device_.workers(), links);
    std::vector<LitBall> balls;
    for (size_t i = 0; i < radiance.size(); ++i) {
        const Probe probe{links.points[i], radiance[i], backs[i]};
        balls.push_back({probe.position, lightingPolynomial(probe.radiance), probe.inside()});
    }
    return balls;
}

} // namespace relume
