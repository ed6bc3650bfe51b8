#include "app/bench/edits_bench.h"

#include "app/bench/edited_bake.h"
#include "app/bench/edited_parts.h"
#include "app/bench/fresh_bakes.h"
#include "app/bench/lamp_placement.h"
#include "app/edit/prepare.h"
#include "app/text/stopwatch.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/foreign/load_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// The moved lamp's place differs by this share of the diagonal from run to run, or its layer of the run
// before would serve. That is far below what an error could show.
constexpr float kRunNudge = 1e-5f;
// Links get one part in so many of the memory that is free before anything is baked: up to three bakes are on
// the device at once.
constexpr uint64_t kCacheShare = 4;
// An object is moved by this share of the diagonal.
constexpr float kObjectWay = 0.05f;

/// Makes the same random numbers on every machine, in [0, 1) [O'Neill 2014, PCG].
class Random {
public:
    explicit Random(uint64_t seed) : state_(2 * seed + 1) {}
    float next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        const auto mixed = static_cast<uint32_t>(((state_ >> 18) ^ state_) >> 27);
        const auto turn = static_cast<uint32_t>(state_ >> 59);
        const uint32_t bits = mixed >> turn | mixed << ((32 - turn) & 31);
        return static_cast<float>(bits >> 8) * 0x1p-24f;
    }

private:
    uint64_t state_;
};

// Returns the lights with any colour and with intensities from a tenth of theirs to twice theirs.
std::vector<Light> weighedAtRandom(std::vector<Light> lights, uint32_t seed) {
    Random random(seed);
    random.next(); // which is close to 0 for small seeds
    for (Light& light : lights) {
        light.intensity *= 0.1f + 1.9f * random.next();
        for (int k = 0; k < 3; ++k)
            light.color[k] *= 0.1f + 0.9f * random.next();
    }
    return lights;
}

template<typename Run, typename T>
T medianOf(const std::vector<Run>& runs, T Run::*member) {
    std::vector<T> values;
    for (const Run& run : runs)
        values.push_back(run.*member);
    return median(std::move(values));
}

// Returns the run in the middle by its time to the end, whose errors and curve are its own.
template<typename Run>
Run middleOf(const std::vector<Run>& runs) {
    const double seconds = medianOf(runs, &Run::seconds);
    Run middle =
        *std::find_if(runs.begin(), runs.end(), [&](const Run& run) { return run.seconds == seconds; });
    middle.seconds5 = medianOf(runs, &Run::seconds5);
    middle.seconds2 = medianOf(runs, &Run::seconds2);
    return middle;
}

/// Measures the links gathered per second of gathering, over the edits that are added.
class GatherRate {
public:
    void add(const SolverCounters& before, const SolverCounters& after) {
        links_ += static_cast<double>(after.pairs - before.pairs);
        seconds_ += after.gatherSeconds - before.gatherSeconds;
    }
    double perSecond() const { return seconds_ > 0 ? links_ / seconds_ : 0.0; }

private:
    double links_ = 0, seconds_ = 0;
};

// Prepares the scene, with lamps alone unless the scene's own light is wanted; lights of the file come later.
PreparedScene prepare(const EditsBenchDesc& desc) {
    PreparedScene prepared = prepareScene(
        {.path = desc.scene, .choice = desc.choice, .size = desc.size, .furnishing = {.daylight = false}});
    if (!desc.onlyLamps) return prepared;
    for (Material& material : prepared.scene.materials)
        material.emission = glm::vec3(0.0f);
    prepared.scene.sky.radiance = glm::vec3(0.0f);
    return prepared;
}

class EditsBench {
public:
    EditsBench(const vk::Device& device, const EditsBenchDesc& desc)
        : EditsBench(device, desc, prepare(desc)) {}

    EditsReport run(const std::function<void(const EditsRun&)>& finished) {
        if (!desc_.sceneOutput.empty()) writeScene();
        spdlog::info("moved lamp: reference");
        references_.lamp =
            fresh_.lightOfNothingElse(moved({lampAt(places_, 0)}), fixed(hybrid(), desc_.referenceSamples));
        for (const uint32_t lamps : desc_.lamps) {
            report_.counts.push_back(measure(lamps));
            finished(report_.counts.back());
        }
        return std::move(report_);
    }

private:
    EditsBench(const vk::Device& device, const EditsBenchDesc& desc, PreparedScene prepared)
        : device_(device), desc_(desc), cacheBytes_(device.freeMemory() / kCacheShare),
          fileLights_(std::exchange(prepared.scene.lights, {})), atlas_(prepared.atlas),
          edited_(device, prepared.scene, prepared.mesh, settings()),
          fresh_(device, prepared.scene, std::move(prepared.mesh), settings()),
          places_(placeLamps(edited_.baker().patches().scene,
                             *std::max_element(desc.lamps.begin(), desc.lamps.end()))) {
        report_ = {.scene = desc.scene,
                   .device = device.info().name,
                   .driver = device.info().driver,
                   .tracer = edited_.baker().tracerChoice(),
                   .version = RELUME_VERSION,
                   .command = {},
                   .placement = lampPlacementText(),
                   .size = desc.size,
                   .patches = edited_.baker().patches().count,
                   .samples = desc.samples,
                   .referenceSamples = desc.referenceSamples,
                   .runs = desc.runs,
                   .error = desc.error,
                   .diagonal = places_.diagonal,
                   .onlyLamps = desc.onlyLamps,
                   .counts = {}};
    }

    BakeSettings settings() const {
        BakeSettings settings;
        settings.size = desc_.size;
        settings.tracer = desc_.tracer;
        settings.solver = layers(); // for objects that move
        return settings;
    }
    SolverSettings hybrid() const {
        SolverSettings settings;
        settings.method = Method::Hybrid;
        settings.error = desc_.error;
        settings.batchMs = desc_.batchMs;
        settings.cache.bytes = cacheBytes_;
        return settings;
    }
    SolverSettings layers() const {
        SolverSettings settings = hybrid();
        settings.layers.on = true;
        // Each layer is to have the error by itself, so that what an edit costs does not depend on how good
        // the composite happens to be.
        settings.layers.error = std::exchange(settings.error, 0.0);
        return settings;
    }
    static SolverSettings live(SolverSettings settings) {
        settings.live = true;
        return settings;
    }
    static SolverSettings fixed(SolverSettings settings, uint32_t samples) {
        settings.error = settings.layers.error = 0;
        settings.links.samples = samples;
        return settings;
    }

    // Writes the scene, for other programs to bake.
    void writeScene() const {
        const Scene before = loadScene(desc_.scene, desc_.choice);
        Scene after = edited_.scene();
        after.lights = moved(lightsOf(*std::max_element(desc_.lamps.begin(), desc_.lamps.end())));
        saveEditedScene(desc_.scene, before, after, desc_.sceneOutput);
        spdlog::info("wrote {}", desc_.sceneOutput);
    }

    // Returns so many lights, of which the first one is always the same.
    std::vector<Light> lightsOf(uint32_t lamps) const {
        const size_t own = std::min<size_t>(fileLights_.size(), lamps - 1);
        std::vector<Light> lights;
        for (uint32_t i = 0; i < lamps - own; ++i)
            lights.push_back(lampAt(places_, i));
        lights.insert(lights.end(), fileLights_.begin(),
                      fileLights_.begin() + static_cast<std::ptrdiff_t>(own));
        return lights;
    }
    std::vector<Light> moved(std::vector<Light> lights, uint32_t run = 0) const {
        const glm::vec3 nudge(static_cast<float>(run) * kRunNudge * places_.diagonal, 0.0f, 0.0f);
        lights.front().transform = glm::translate(glm::mat4(1.0f), places_.moved + nudge);
        return lights;
    }

    EditsRun measure(uint32_t lamps) {
        EditsRun run;
        run.lamps = lamps;
        const std::vector<Light> lights = lightsOf(lamps);
        spdlog::info("{} lamps: first bake", lamps);
        run.firstBakeSeconds = edited_.restart(lights, live(layers()));
        spdlog::info("{} lamps: weights", lamps);
        run.weights = measureWeights(lights);
        spdlog::info("{} lamps: reference", lamps);
        references_.all = fresh_.light(moved(lights), fixed(hybrid(), desc_.referenceSamples));
        spdlog::info("{} lamps: moves", lamps);
        run.move = measureMoves(lights, run.links);
        run.albedo = measureAlbedo(run.links);
        spdlog::info("{} lamps: object", lamps);
        run.object = measureObject(lights);
        const SolverProgress& progress = edited_.progress();
        const double links = static_cast<double>(report_.patches) * progress.samples;
        run.links.bytes = progress.cacheBytes;
        run.links.bytesPerLink = links > 0 ? static_cast<double>(progress.cacheBytes) / links : 0.0;
        spdlog::info("{} lamps: fresh bakes", lamps);
        run.layers = measureFresh(moved(lights), layers());
        run.hybrid = measureFresh(moved(lights), hybrid());
        return run;
    }

    MeasuredWeights measureWeights(const std::vector<Light>& lights) {
        const SolverCounters before = edited_.progress();
        std::vector<double> seconds;
        for (uint32_t run = 1; run <= desc_.runs; ++run)
            seconds.push_back(edited_.weigh(weighedAtRandom(lights, run)));
        edited_.weigh(lights);
        MeasuredWeights edit;
        edit.seconds = median(std::move(seconds));
        edit.rays = edited_.progress().rays - before.rays;
        edit.links = edited_.progress().pairs - before.pairs;
        const SolverSettings layered = fixed(layers(), desc_.samples);
        const std::vector<Light> weighed = weighedAtRandom(lights, 1);
        const PatchLight sum = fresh_.weighedLight(lights, weighed, layered);
        const auto off = [&](const SolverSettings& settings) {
            return compareLight(fresh_.patches(), sum, fresh_.light(weighed, settings)).maximum;
        };
        edit.maximumOfLayers = off(layered);
        edit.maximumOfHybrid = off(fixed(hybrid(), desc_.samples));
        return edit;
    }

    MeasuredMove measureMoves(const std::vector<Light>& lights, LinkFigures& links) {
        const PatchLight first = edited_.firstLamp();
        std::vector<MeasuredMove> runs;
        GatherRate rate;
        for (uint32_t run = 0; run < desc_.runs; ++run) {
            const SolverCounters before = edited_.progress();
            runs.push_back(edited_.move(moved(lights, run), references_));
            rate.add(before, edited_.progress());
            edited_.undo(lights, first, runs.back());
        }
        links.perSecondMove = rate.perSecond();
        MeasuredMove edit = middleOf(runs);
        edit.firstSeconds = medianOf(runs, &MeasuredMove::firstSeconds);
        edit.undoSeconds = medianOf(runs, &MeasuredMove::undoSeconds);
        edit.undoSameBytes =
            std::all_of(runs.begin(), runs.end(), [](const MeasuredMove& run) { return run.undoSameBytes; });
        return edit;
    }

    std::optional<MeasuredAlbedo> measureAlbedo(LinkFigures& links) {
        const Scene& scene = edited_.scene();
        const std::optional<uint32_t> index = largestMaterial(edited_.baker().patches().scene.mesh, scene);
        if (!index) return {};
        const glm::vec4 colour = scene.materials[*index].baseColor;
        MeasuredAlbedo edit;
        edit.material = scene.materials[*index].name;
        std::vector<double> first, all;
        GatherRate rate;
        for (uint32_t run = 0; run < desc_.runs; ++run) {
            // Each run has another colour, or the layers of the run before would serve.
            const float factor = 0.8f - 0.4f * static_cast<float>(run) / static_cast<float>(desc_.runs);
            const SolverCounters before = edited_.progress();
            const EditedBake::Seen times =
                edited_.repaint(*index, glm::vec4(factor * glm::vec3(colour), colour.a));
            rate.add(before, edited_.progress());
            edit.rays = std::max(edit.rays, edited_.progress().rays - before.rays);
            first.push_back(times.first);
            edit.firstError = times.firstError;
            all.push_back(times.all);
            edited_.repaint(*index, colour);
        }
        edit.firstSeconds = median(std::move(first));
        edit.seconds = median(std::move(all));
        links.perSecondAlbedo = rate.perSecond();
        return edit;
    }

    // Moves an object there and back again. Places differ from run to run as those of a moved lamp do.
    std::optional<MeasuredObject> measureObject(const std::vector<Light>& lights) {
        const Scene& scene = edited_.scene();
        const auto object = smallObject(edited_.baker().patches().scene.mesh, scene);
        if (!object) return {};
        const auto [index, share] = *object;
        const glm::mat4 home = scene.instances[index].transform;
        MeasuredObject edit;
        edit.object = scene.instances[index].name;
        edit.share = share;
        std::vector<double> follow, first, all;
        for (uint32_t run = 0; run < desc_.runs; ++run) {
            const glm::vec3 way(kObjectWay + static_cast<float>(run) * kRunNudge, 0.0f, 0.0f);
            const glm::mat4 there = glm::translate(glm::mat4(1.0f), places_.diagonal * way) * home;
            const uint64_t rays = edited_.progress().rays;
            const auto times = edited_.place(index, there, atlas_);
            if (!times) return {};
            follow.push_back(times->follow);
            first.push_back(times->seen.first);
            edit.firstError = times->seen.firstError;
            all.push_back(times->seen.end);
            edit.rays = std::max(edit.rays, edited_.progress().rays - rays);
            if (run == 0) measureFreshObject(lights, edit);
            edited_.place(index, home, atlas_);
        }
        edit.followSeconds = median(std::move(follow));
        edit.firstSeconds = median(std::move(first));
        edit.seconds = median(std::move(all));
        return edit;
    }

    // Bakes the scene as it is edited now, from nothing.
    void measureFreshObject(const std::vector<Light>& lights, MeasuredObject& edit) {
        Stopwatch watch;
        EditedBake fresh = watch([&] {
            return EditedBake(device_, edited_.scene(), flatten(edited_.scene(), atlas_), settings());
        });
        edit.freshPreparation = watch.seconds;
        edit.freshSeconds = fresh.restart(lights, live(layers()));
        edit.freshRays = fresh.progress().rays;
        edit.difference = compareLight(edited_.baker().patches(), edited_.light(), fresh.light()).relRmse;
    }

    FreshBake measureFresh(const std::vector<Light>& lights, const SolverSettings& settings) {
        std::vector<FreshBake> runs;
        for (uint32_t run = 0; run < desc_.runs; ++run)
            runs.push_back(fresh_.measure(lights, settings, references_.all));
        return middleOf(runs);
    }

    const vk::Device& device_;
    const EditsBenchDesc& desc_;
    uint64_t cacheBytes_; // for links, of every bake
    std::vector<Light> fileLights_;
    LightmapAtlas atlas_;
    EditedBake edited_;
    FreshBakes fresh_;
    LampPlaces places_;
    MoveReferences references_;
    EditsReport report_;
};

} // namespace

EditsReport benchEdits(const vk::Device& device, const EditsBenchDesc& desc,
                       const std::function<void(const EditsRun&)>& finished) {
    ASSERT(!desc.lamps.empty() && desc.runs > 0);
    return EditsBench(device, desc).run(finished);
}

} // namespace relume
