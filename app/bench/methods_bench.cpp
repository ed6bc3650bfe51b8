#include "app/bench/methods_bench.h"

#include "app/edit/prepare.h"
#include "app/text/heat_map.h"
#include "app/text/interrupt.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/flip.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace relume {
namespace {

// Programs are compiled when they first run, so a small bake of each method goes before what is measured.
constexpr uint32_t kWarmUpSize = 32;
// Pictures in the report are not larger [texels].
constexpr uint32_t kPictureEdge = 512;

/// A method with its settings.
struct Variant {
    Method method;
    std::string setting;
    SolverSettings solver;
};

/// A finished bake.
struct Baked {
    FloatImage map;
    SolverProgress progress;
    std::string tracer;
    uint32_t patches = 0;
    double seconds = 0; // in all
};

std::vector<Variant> variantsOf(const MethodsBenchDesc& desc, Method method) {
    SolverSettings common;
    common.method = method;
    common.cache = desc.cache;
    common.passes = desc.passes;
    common.error = 0.0;
    common.links.smooth = desc.smooth;
    std::vector<Variant> variants;
    const auto add = [&](const std::string& setting, const SolverSettings& solver) {
        variants.push_back({method, setting, solver});
    };
    if (method == Method::Pure) {
        add("", common);
    } else if (method == Method::Adaptive) {
        for (uint32_t node : desc.nodes) {
            for (double threshold : desc.thresholds) {
                SolverSettings solver = common;
                solver.pairs.node = node;
                solver.pairs.threshold = threshold;
                add(fmt::format("node {} T {:g}", node, threshold), solver);
            }
        }
    } else if (isPairMethod(method)) {
        for (uint32_t window : desc.windows) {
            SolverSettings solver = common;
            solver.pairs.window = window;
            add(fmt::format("window {}", window), solver);
        }
    } else {
        for (uint32_t samples : desc.samples) {
            SolverSettings solver = common;
            solver.links.samples = samples;
            add(fmt::format("{} samples", samples), solver);
        }
    }
    return variants;
}

// Returns the image with its longer edge at most `most`: each texel is the mean of those that fall together.
FloatImage shrunk(const FloatImage& image, uint32_t most) {
    const uint32_t factor = (std::max(image.width, image.height) + most - 1) / most;
    if (factor <= 1) return image;
    FloatImage small{std::max(1u, image.width / factor), std::max(1u, image.height / factor), {}, {}, {}};
    for (size_t c = 0; c < image.channels.size(); ++c) {
        std::vector<float>& plane = small.add(image.channels[c]);
        for (uint32_t y = 0; y < small.height; ++y) {
            for (uint32_t x = 0; x < small.width; ++x) {
                double sum = 0;
                for (uint32_t k = 0; k < factor * factor; ++k)
                    sum += image.planes[c][static_cast<size_t>(y * factor + k / factor) * image.width +
                                           x * factor + k % factor];
                plane[static_cast<size_t>(y) * small.width + x] = static_cast<float>(sum / (factor * factor));
            }
        }
    }
    return small;
}

class MethodsBench {
public:
    MethodsBench(const vk::Device& device, const MethodsBenchDesc& desc) : device_(device), desc_(desc) {
        pictureSize_ =
            desc.pictureSize > 0 ? desc.pictureSize : *std::max_element(desc.sizes.begin(), desc.sizes.end());
        report_.scene = desc.scene;
        report_.device = device.info().name;
        report_.driver = device.info().driver;
        report_.version = RELUME_VERSION;
        report_.passes = desc.passes;
    }

    MethodsReport run(const std::function<void(const MethodRun&)>& finished) {
        warmUp();
        for (uint32_t size : desc_.sizes) {
            prepare(size);
            bakeReference(size);
            pure_.reset();
            for (Method method : desc_.methods) {
                for (const Variant& variant : variantsOf(desc_, method)) {
                    report_.runs.push_back(measure(variant, size));
                    finished(report_.runs.back());
                }
            }
        }
        drawDifferences();
        return std::move(report_);
    }

private:
    struct Difference { // from the reference, relative to its mean
        size_t run;
        double error;
        uint32_t width;
        std::vector<float> values;
        std::vector<bool> covered;
    };

    void prepare(uint32_t size) {
        prepared_ = prepareScene({.path = desc_.scene, .choice = desc_.choice, .size = size});
    }

    void warmUp() {
        prepare(kWarmUpSize);
        for (Method method : desc_.methods) {
            Variant variant = variantsOf(desc_, method).front();
            variant.solver.links.samples = std::min(variant.solver.links.samples, kWarmUpSize);
            try {
                bake(variant.solver, kWarmUpSize);
            } catch (const Error& error) {
                if (InterruptGuard::requested()) throw;
                spdlog::debug("{}: {}", methodName(method), error.what()); // is told when it is measured
            }
        }
    }

    // Bakes, and throws Error where the bake cannot be made or takes too long.
    Baked bake(const SolverSettings& solver, uint32_t size) {
        const auto start = Clock::now();
        BakeSettings settings;
        settings.size = size;
        settings.tracer = desc_.tracer;
        settings.solver = solver;
        Baker baker(device_, prepared_.scene, prepared_.mesh, settings);
        while (!baker.solver().done()) {
            baker.solver().step();
            if (InterruptGuard::requested()) throw Error("interrupted: nothing was written");
            if (baker.solver().progress().seconds > desc_.maxSeconds)
                throw Error(fmt::format("given up after {:g} s: raise --max-seconds", desc_.maxSeconds));
        }
        Baked baked;
        baked.map = baker.lightmap({});
        baked.tracer = baker.tracer().name();
        baked.seconds = secondsSince(start);
        baked.progress = baker.solver().progress();
        baked.patches = baker.patches().count;
        return baked;
    }

    void bakeReference(uint32_t size) {
        SolverSettings solver;
        solver.method = Method::Hybrid;
        solver.passes = desc_.passes;
        solver.error = 0.0;
        solver.links.samples = desc_.referenceSamples;
        solver.links.smooth = false;
        reference_.reset();
        referenceNote_.clear();
        try {
            reference_ = bake(solver, size).map;
            report_.reference = fmt::format(
                "hybrid with {} directions per patch, not smoothed, as many passes", desc_.referenceSamples);
        } catch (const Error& error) {
            if (InterruptGuard::requested()) throw;
            referenceNote_ = fmt::format("no reference: {}", error.what());
            spdlog::warn("{}² {}", size, referenceNote_);
        }
    }

    MethodRun measure(const Variant& variant, uint32_t size) {
        MethodRun run;
        run.method = methodName(variant.method);
        run.setting = variant.setting;
        run.size = size;
        try {
            Baked baked = bake(variant.solver, size);
            const SolverProgress& p = baked.progress;
            report_.tracer = baked.tracer;
            run.patches = baked.patches;
            run.solveSeconds = p.seconds;
            run.passSeconds = p.seconds / desc_.passes;
            run.totalSeconds = baked.seconds;
            run.rays = p.rays;
            run.note = referenceNote_;
            compare(run, baked.map);
            if (size == pictureSize_) run.picture = encodePng(shrunk(baked.map, kPictureEdge), run.method);
            if (variant.method == Method::Pure) pure_ = std::move(baked.map);
        } catch (const Error& error) {
            if (InterruptGuard::requested()) throw;
            run.note = error.what();
            spdlog::warn("{} at {}²: {}", run.method, size, error.what());
        }
        return run;
    }

    void compare(MethodRun& run, const FloatImage& map) {
        if (run.method == methodName(Method::Pure))
            run.dfpr = 0.0;
        else if (pure_)
            run.dfpr = compareImages(map, run.method, *pure_, "pure").dfpr;
        if (!reference_) return;
        const ImagePair pair({map, run.method}, {*reference_, "reference"});
        const Metrics metrics = pair.measure();
        run.relRmse = metrics.relRmse;
        run.localError = pair.percentiles(pair.localErrors()).p95;
        run.flip = pair.mean(pair.flipDifferences(kFlipPixelsPerDegree));
        if (run.size != pictureSize_ || metrics.meanB <= 0) return;
        Difference difference{report_.runs.size(), metrics.relRmse, pair.width(), pair.differences(),
                              pair.covered()};
        for (float& value : difference.values)
            value = static_cast<float>(value / metrics.meanB);
        differences_.push_back(std::move(difference));
    }

    // Draws all with one scale, which the middle one fills: otherwise the worst would leave the others black.
    void drawDifferences() {
        if (differences_.empty()) return;
        std::vector<size_t> order(differences_.size());
        std::iota(order.begin(), order.end(), size_t{0});
        std::sort(order.begin(), order.end(),
                  [&](size_t a, size_t b) { return differences_[a].error < differences_[b].error; });
        const Difference& middle = differences_[order[order.size() / 2]];
        report_.differenceScale = heatScale(middle.values, middle.covered);
        for (const Difference& d : differences_)
            report_.runs[d.run].difference = encodePng(
                shrunk(heatMap(d.width, d.values, d.covered, report_.differenceScale), kPictureEdge), "map");
    }

    const vk::Device& device_;
    const MethodsBenchDesc& desc_;
    uint32_t pictureSize_ = 0;
    PreparedScene prepared_;
    std::optional<FloatImage> reference_, pure_; // of the current size
    std::string referenceNote_;
    std::vector<Difference> differences_;
    MethodsReport report_;
};

} // namespace

MethodsReport benchMethods(const vk::Device& device, const MethodsBenchDesc& desc,
                           const std::function<void(const MethodRun&)>& finished) {
    ASSERT(!desc.sizes.empty() && !desc.methods.empty());
    return MethodsBench(device, desc).run(finished);
}

} // namespace relume
