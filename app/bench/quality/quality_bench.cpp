#include "app/bench/quality/quality_bench.h"

#include "app/bench/quality/quality_pictures.h"
#include "app/edit/prepare.h"
#include "app/text/interrupt.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"

#include <filesystem>
#include <memory>

namespace relume {
namespace {

constexpr double kLookEvery = 2; // times the rays of the last look
constexpr uint32_t kWarmUpSamples = 16;

SolverSettings settingsOf(const QualityBenchDesc& desc, const std::string& mode) {
    SolverSettings solver;
    solver.method = Method::Hybrid;
    solver.error = desc.error;
    solver.localError = desc.localError;
    solver.batchMs = desc.batchMs;
    solver.layers.on = mode == "layers";
    solver.links.perChunk = mode == "per-chunk";
    solver.links.uniform = mode == "uniform";
    return solver;
}

// Its directions are scrambled otherwise than those of what is measured, whose noise it must not share.
SolverSettings settingsOfReference(const QualityBenchDesc& desc) {
    SolverSettings solver = settingsOf(desc, "plain");
    solver.error = solver.localError = 0;
    solver.links.samples = desc.referenceSamples;
    solver.links.smooth = false;
    solver.links.rotation = Rotation::Interleaved;
    return solver;
}

std::vector<LitPoint> pointsOf(const PatchSet& patches, const FloatImage& reference) {
    const auto &r = *reference.find("R"), &g = *reference.find("G"), &b = *reference.find("B");
    std::vector<LitPoint> points;
    for (uint32_t i = 0; i < patches.count; ++i) {
        const shader::Patch& patch = patches.scene.patches[i];
        if (!shader::patchIsShown(patch.flags)) continue;
        const uint32_t texel = shader::patchTexel(patch.flags);
        points.push_back({.position = patch.position,
                          .normal = patch.normal,
                          .area = patch.area,
                          .light = (r[texel] + g[texel] + b[texel]) / 3.0f});
    }
    return points;
}

class QualityBench {
public:
    QualityBench(const vk::Device& device, const QualityBenchDesc& desc) : device_(device), desc_(desc) {
        report_.scene = desc.scene;
        report_.device = device.info().name;
        report_.driver = device.info().driver;
        report_.version = RELUME_VERSION;
        report_.size = desc.size;
        report_.error = desc.error;
        report_.localError = desc.localError;
    }

    QualityReport run(const std::function<void(const QualityRun&)>& finished) {
        const auto start = Clock::now();
        prepared_ = prepareScene({.path = desc_.scene, .choice = desc_.choice, .size = desc_.size});
        prepareSeconds_ = secondsSince(start);
        if (desc_.flip) pictures_ = std::make_unique<QualityPictures>(prepared_);
        findReference();
        for (const std::string& mode : desc_.modes) {
            report_.runs.push_back(
                {.mode = mode, .patches = 0, .converged = false, .points = {}, .note = {}});
            QualityRun& run = report_.runs.back();
            try {
                measure(run);
            } catch (const Error& error) {
                run.note = error.what();
                spdlog::warn("{}: {}", mode, error.what());
            }
            finished(run);
            report_.interrupted = InterruptGuard::requested();
            if (report_.interrupted) break;
        }
        return std::move(report_);
    }

private:
    std::unique_ptr<Baker> baker(const SolverSettings& solver) {
        BakeSettings settings;
        settings.size = desc_.size;
        settings.tracer = desc_.tracer;
        settings.solver = solver;
        auto made = std::make_unique<Baker>(device_, prepared_.scene, prepared_.mesh, settings);
        report_.tracer = made->tracerChoice();
        return made;
    }

    void findReference() {
        const bool made = desc_.reference.empty() || !std::filesystem::exists(desc_.reference);
        SolverSettings solver = settingsOfReference(desc_);
        if (!made) solver.links.samples = kWarmUpSamples; // of its patches alone there is need
        const std::unique_ptr<Baker> bake = baker(solver);
        if (made) {
            spdlog::info("reference: {} directions per patch", desc_.referenceSamples);
            while (!bake->solver().done()) {
                bake->solver().step();
                stopIfInterrupted();
            }
            reference_ = bake->lightmap({});
            reference_.attributes["relume:scene"] = desc_.scene.substr(desc_.scene.find_last_of('/') + 1);
            reference_.attributes["relume:quantity"] = "lighting";
            if (!desc_.reference.empty()) writeImage(desc_.reference, reference_);
            report_.reference = fmt::format("{} directions per patch, scrambled otherwise, not smoothed",
                                            desc_.referenceSamples);
        } else {
            reference_ = readImage(desc_.reference);
            checkReference();
            report_.reference = desc_.reference;
        }
        if (!pictures_) return;
        pictures_->begin(reference_, pointsOf(bake->patches(), reference_), desc_.pictures);
        report_.pictures = pictures_->names();
    }

    void checkReference() const {
        if (reference_.width != desc_.size || reference_.height != desc_.size)
            throw Error(fmt::format("{}: is {} x {}: pass --size {} or another file", desc_.reference,
                                    reference_.width, reference_.height, reference_.width));
        for (const char* channel : {"R", "G", "B"})
            if (reference_.find(channel) == nullptr)
                throw Error(desc_.reference + ": has no channel " + channel + ": take a lightmap");
        const auto from = reference_.attributes.find("relume:scene");
        const std::string scene = desc_.scene.substr(desc_.scene.find_last_of('/') + 1);
        if (from != reference_.attributes.end() && from->second != scene)
            spdlog::warn("{}: is a lightmap of {}, not of {}", desc_.reference, from->second, scene);
    }

    // Programs are compiled when they first run, which is not to be measured.
    void warmUp(const std::string& mode) {
        SolverSettings solver = settingsOf(desc_, mode);
        solver.links.samples = kWarmUpSamples;
        const std::unique_ptr<Baker> bake = baker(solver);
        while (!bake->solver().done()) {
            bake->solver().step();
            if (InterruptGuard::requested()) return;
        }
        bake->solver().light();
    }

    void measure(QualityRun& run) {
        spdlog::info("{}", run.mode);
        warmUp(run.mode);
        auto start = Clock::now();
        const std::unique_ptr<Baker> bake = baker(settingsOf(desc_, run.mode));
        const double before = prepareSeconds_ + secondsSince(start);
        Solver& solver = bake->solver();
        run.patches = bake->patches().count;
        double stepSeconds = 0, nextRays = 0;
        while (!solver.done() && !InterruptGuard::requested()) {
            start = Clock::now();
            solver.step();
            stepSeconds += secondsSince(start);
            if (!solver.passBoundary()) continue;
            const SolverProgress& p = solver.progress();
            const auto rays = static_cast<double>(p.rays);
            const bool ends =
                solver.done() || p.seconds > desc_.seconds || (desc_.rays > 0 && rays > desc_.rays);
            // Before the first directions are followed, there is no bounce to be seen.
            if (!ends && (p.samples == 0 || rays < nextRays)) continue;
            nextRays = kLookEvery * rays;
            run.points.push_back(look(*bake, before + stepSeconds, ends ? run.mode : ""));
            if (ends) break;
        }
        run.converged = solver.done() && solver.progress().converged;
    }

    QualityPoint look(Baker& bake, double processSeconds, const std::string& pictureName) {
        const FloatImage map = bake.lightmap({});
        const ImagePair pair({map, "lightmap"}, {reference_, "reference"});
        const LocalPercentiles local = pair.percentiles(pair.localErrors());
        const SolverProgress& p = bake.solver().progress();
        QualityPoint point{.samples = p.samples,
                           .rays = p.rays,
                           .seconds = p.seconds,
                           .processSeconds = processSeconds,
                           .relRmse = pair.measure().relRmse,
                           .local50 = local.p50,
                           .local95 = local.p95,
                           .local99 = local.p99,
                           .toldError = p.error,
                           .toldLocal95 = p.localError95,
                           .toldLocal99 = p.localError99,
                           .flip = {}};
        if (pictures_) point.flip = pictures_->compare(map, pictureName);
        return point;
    }

    const vk::Device& device_;
    const QualityBenchDesc& desc_;
    double prepareSeconds_ = 0;
    PreparedScene prepared_;
    std::unique_ptr<QualityPictures> pictures_;
    FloatImage reference_;
    QualityReport report_;
};

} // namespace

QualityReport benchQuality(const vk::Device& device, const QualityBenchDesc& desc,
                           const std::function<void(const QualityRun&)>& finished) {
    return QualityBench(device, desc).run(finished);
}

} // namespace relume
