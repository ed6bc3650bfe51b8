#include "app/bench/reload_bench.h"

#include "app/bench/edited_parts.h"
#include "app/bench/edits_report.h"
#include "app/bench/lamp_placement.h"
#include "app/bench/map_sink.h"
#include "app/edit/prepare.h"
#include "app/live/session.h"
#include "app/offline/solve.h"
#include "app/text/interrupt.h"
#include "app/text/stopwatch.h"
#include "assets/atlas/uv_sets.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/passing_folder.h"
#include "assets/foreign/load_scene.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "assets/gltf/gltf.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <thread>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// Places and colours differ by this share from run to run, or the layers of the run before would serve.
constexpr float kNudge = 1e-4f;
constexpr float kObjectStep = 0.05f;    // of the diagonal, by which an object is moved
constexpr float kDimmed = 0.8f;         // a base colour becomes this share of itself
constexpr uint32_t kProbeStride = 61;   // every so many texels a layer is looked at; a prime, so no column
constexpr double kFollowPatience = 600; // [s] that a bake may take to follow an edit
constexpr uint32_t kPlacingSize = 64;   // lightmap edge that places for lamps are sought with [texels]

/// An edit of what a file holds; `run` counts from 0, and each run makes another one.
struct BenchEdit {
    std::string name;
    LightKey light; // whose layer it changes alone, where it is a lamp's
    std::function<void(SceneEdits&, uint32_t run)> make;
    // Brings about the same light by what the viewer cannot edit; empty: the file is edited likewise.
    std::function<void(Scene&, uint32_t run)> inFile = {};
};

/// Gives an object a mesh of its own, with its corners `way` from where they were in the world.
void shiftMesh(Scene& scene, size_t object, const glm::vec3& way) {
    Instance& instance = scene.instances[object];
    Mesh mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
    const glm::vec3 own = glm::inverse(glm::mat3(instance.transform)) * way;
    for (Primitive& primitive : mesh.primitives)
        for (glm::vec3& position : primitive.positions)
            position += own;
    instance.mesh = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
}

BakeRequest requestOf(const ReloadBenchDesc& desc, const std::string& level) {
    BakeRequest request;
    request.prepare = {.path = level, .size = desc.size, .furnishing = {.daylight = false}};
    request.bake.size = desc.size;
    request.bake.tracer = desc.tracer;
    SolverSettings& solver = request.bake.solver;
    solver.method = Method::Hybrid;
    solver.layers.on = true;
    solver.error = desc.samples > 0 ? 0.0 : desc.error;
    solver.links.samples = desc.samples;
    return request;
}

// Prepares the scene for the search of places for lamps, which need no fine lightmap. Where UVs are made it
// is the bake's, in which all charts have room.
PreparedScene placingOf(const ReloadBenchDesc& desc) {
    const bool mapped = countUnmapped(loadScene(desc.scene, desc.choice)) == 0;
    return prepareScene({.path = desc.scene,
                         .choice = desc.choice,
                         .size = mapped ? kPlacingSize : desc.size,
                         .furnishing = {.daylight = false}});
}

class ReloadBench {
public:
    /// `placing` is the scene as placingOf() has it.
    ReloadBench(const ReloadBenchDesc& desc, PreparedScene placing)
        : desc_(desc), device_({.select = desc.device}), level_(folder_.file("level.glb")),
          request_(requestOf(desc, level_)), bake_({.device = desc.device, .batchMs = desc.batchMs}),
          sink_(bake_.exchange()), session_(bake_, request_) {
        makeLevel(std::move(placing));
    }
    ~ReloadBench() { bake_.stop(); } // before the memory goes that it writes

    ReloadReport run() {
        session_.watchFile(true);
        session_.open(level_);
        waitFor([&] { return session_.scene() != nullptr; });
        waitUntilDone();
        describeBake();
        for (const BenchEdit& edit : edits()) {
            spdlog::info("{}: {} runs", edit.name, desc_.runs);
            report_.edits.push_back(measure(edit));
        }
        report_.readSeconds = reading();
        if (desc_.changes > 0) changeAtRandom();
        report_.beginnings = bake_.status().beginnings;
        return std::move(report_);
    }

private:
    // Writes the scene with the lamps, which light it alone.
    void makeLevel(PreparedScene placing) {
        BakeSettings settings = request_.bake;
        settings.size = placing.size;
        WorldMesh mesh = placing.mesh;
        const Baker baker(device_, placing.scene, std::move(placing.mesh), settings);
        places_ = placeLamps(baker.patches().scene, desc_.lamps);
        material_ = largestMaterial(mesh, placing.scene);
        if (const auto object = smallObject(mesh, placing.scene)) object_ = object->first;
        const Scene before = loadScene(desc_.scene, desc_.choice);
        Scene after = before;
        for (Material& material : after.materials)
            material.emission = glm::vec3(0.0f);
        static_cast<SkySettings&>(after.sky) = {};
        after.lights.clear();
        for (uint32_t i = 0; i < desc_.lamps; ++i) {
            after.lights.push_back(lampAt(places_, i));
            after.lights.back().name = fmt::format("Lamp {}", i);
        }
        const std::string lit = folder_.file("lit.glb");
        saveEditedScene(desc_.scene, before, after, lit);
        saveGlb(loadScene(lit), level_);
        // Normals are made unit whenever a file is read, and settle in their last bits after a few times.
        constexpr int kSettled = 10;
        for (int i = 0; i < kSettled; ++i)
            saveGlb(loadScene(level_), level_);
        home_ = loadScene(level_);
    }

    std::vector<BenchEdit> edits() const {
        std::vector<BenchEdit> out;
        out.push_back({"lamp moved", {LightKey::Kind::Lamp, 0, 0}, [this](SceneEdits& edits, uint32_t run) {
                           const glm::vec3 nudge(nudgeOf(run) * places_.diagonal, 0.0f, 0.0f);
                           edits.lights[0].transform = glm::translate(glm::mat4(1.0f), places_.moved + nudge);
                       }});
        if (object_) {
            const auto move = [this](SceneEdits& edits, uint32_t run) {
                glm::mat4& place = edits.placements[*object_].transform;
                place = glm::translate(glm::mat4(1.0f), wayOf(run)) * place;
            };
            out.push_back({"object moved", {}, move});
            out.push_back({"mesh changed", {}, move, [this](Scene& scene, uint32_t run) {
                               shiftMesh(scene, *object_, wayOf(run));
                           }});
            out.push_back({"object removed",
                           {},
                           [this](SceneEdits& edits, uint32_t) { edits.placements[*object_].hidden = true; },
                           [this](Scene& scene, uint32_t) {
                               scene.instances.erase(scene.instances.begin() + std::ptrdiff_t{*object_});
                           }});
        }
        if (material_) {
            const auto dim = [this](SceneEdits& edits, uint32_t run) {
                glm::vec4& colour = edits.materials[*material_].baseColor;
                colour = glm::vec4((kDimmed - nudgeOf(run)) * glm::vec3(colour), colour.a);
            };
            out.push_back({"base colour", {}, dim});
            // A smooth metal sends nothing on (assets/gltf/README.md): this share of one is as dark.
            out.push_back({"surface changed", {}, dim, [this](Scene& scene, uint32_t run) {
                               Material& material = scene.materials[*material_];
                               const float diffuse =
                                   1.0f - material.metallic +
                                   0.5f * material.metallic * material.roughness * material.roughness;
                               material.metallic = 1.0f - (kDimmed - nudgeOf(run)) * diffuse;
                               material.roughness = 0.0f;
                           }});
        }
        return out;
    }
    glm::vec3 wayOf(uint32_t run) const {
        return places_.diagonal * glm::vec3(kObjectStep + nudgeOf(run), 0.0f, 0.0f);
    }
    static float nudgeOf(uint32_t run) { return static_cast<float>(run + 1) * kNudge; }

    MeasuredReload measure(const BenchEdit& edit) {
        MeasuredReload out{.edit = edit.name};
        const bool ofLamp = edit.light.kind == LightKey::Kind::Lamp;
        std::vector<double> file, viewer, fileRays, viewerRays;
        for (uint32_t run = 0; run < desc_.runs; ++run) {
            const auto before = ofLamp ? layers() : Layers();
            const Scene there = editedFile(edit, 2 * run);
            file.push_back(untilSeen([&] { writeLevel(there); }));
            fileRays.push_back(raysUntilDone());
            if (ofLamp) countKept(edit.light, before, layers(), out);
            untilSeen([&] { writeLevel(home_); });
            waitUntilDone();

            Document document = session_.document();
            edit.make(document.edits, 2 * run + 1);
            viewer.push_back(untilSeen([&] { session_.edit(edit.name, document); }));
            session_.endEdit();
            viewerRays.push_back(raysUntilDone());
            untilSeen([&] { session_.undo(); });
            waitUntilDone();
        }
        out.fileSeconds = median(file);
        out.viewerSeconds = median(viewer);
        out.fileRays = static_cast<uint64_t>(median(fileRays));
        out.viewerRays = static_cast<uint64_t>(median(viewerRays));
        return out;
    }

    Scene editedFile(const BenchEdit& edit, uint32_t run) const {
        Scene scene = home_;
        if (edit.inFile) {
            edit.inFile(scene, run);
        } else {
            SceneEdits edits = editsOf(scene);
            edit.make(edits, run);
            applyEdits(scene, edits);
        }
        return scene;
    }

    // Writes the file as an exporter does, under another name first.
    void writeLevel(const Scene& scene) {
        const std::string next = folder_.file("next.glb");
        saveGlb(scene, next);
        rays_ = bake_.status().progress.rays;
        written_ = Clock::now();
        std::filesystem::rename(next, level_);
    }

    // Returns how long it takes from the end of `change` until its light is on screen, bounces and all [s]. A
    // map bears the number of an edit as soon as the bake follows it; what it shows is older until it is
    // current.
    double untilSeen(const std::function<void()>& change) {
        const uint64_t bake = session_.newestBake();
        rays_ = bake_.status().progress.rays;
        written_ = Clock::now();
        change();
        waitFor([&] {
            return session_.newestBake() > bake && sink_.map() &&
                   sink_.map()->bake == session_.newestBake() && sink_.map()->complete &&
                   sink_.map()->current;
        });
        return secondsSince(written_);
    }
    void waitUntilDone() {
        waitFor([&] {
            const BakeStatus status = bake_.status();
            return status.phase == BakeStatus::Phase::Done && status.bake == session_.newestBake();
        });
    }
    double raysUntilDone() {
        waitUntilDone();
        const uint64_t rays = bake_.status().progress.rays;
        return static_cast<double>(rays >= rays_ ? rays - rays_ : rays); // less: the bake began anew
    }
    void waitFor(const std::function<bool()>& what) {
        const auto start = Clock::now();
        for (; !what(); std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
            stopIfInterrupted();
            session_.update();
            sink_.update();
            const BakeStatus status = bake_.status();
            if (status.phase == BakeStatus::Phase::Failed) throw Error(status.doing);
            if (const auto failure = session_.takeOpenFailure()) throw Error(failure->message);
            if (!session_.lastError().empty()) throw Error(session_.lastError());
            if (secondsSince(start) > kFollowPatience)
                throw Error(fmt::format("the bake has not followed after {:g} s: use a smaller --size",
                                        kFollowPatience));
        }
    }

    // Returns what the layer of each light holds at some texels.
    using Layers = std::map<LightKey, std::vector<glm::vec3>>;
    Layers layers() {
        ProbeRequest request{.number = ++probes_, .texels = {}};
        for (uint32_t texel = 0; texel < desc_.size * desc_.size; texel += kProbeStride)
            request.texels.push_back(texel);
        bake_.askProbes(request);
        Layers out;
        waitFor([&] {
            while (const auto probe = bake_.exchange().takeProbe())
                if (probe->request == request.number) out[probe->key] = probe->light;
            return out.size() == desc_.lamps;
        });
        return out;
    }
    static void countKept(const LightKey& changed, const Layers& before, const Layers& after,
                          MeasuredReload& out) {
        uint32_t kept = 0;
        for (const auto& [key, light] : before)
            kept += key != changed && after.at(key) == light;
        out.layersKept = out.layersAll == 0 ? kept : std::min(out.layersKept, kept);
        out.layersAll = static_cast<uint32_t>(before.size()) - 1;
    }

    double reading() const {
        std::vector<double> seconds;
        for (uint32_t run = 0; run < desc_.runs; ++run) {
            Stopwatch watch;
            watch([&] { return prepareScene(request_.prepare); });
            seconds.push_back(watch.seconds);
        }
        return median(std::move(seconds));
    }

    void changeAtRandom() {
        spdlog::info("{} random changes", desc_.changes);
        Scene scene = home_;
        std::vector<bool> gone(home_.instances.size(), false);
        std::mt19937 random(1);
        for (uint32_t change = 0; change < desc_.changes; ++change) {
            changeOnce(scene, gone, random);
            Scene left = scene;
            for (size_t i = gone.size(); i-- > 0;)
                if (gone[i]) left.instances.erase(left.instances.begin() + static_cast<std::ptrdiff_t>(i));
            untilSeen([&] { writeLevel(left); });
            ++report_.changes;
        }
        waitUntilDone();
        report_.difference = differenceFromFresh();
    }
    // Makes one change of any kind. One object at least stays.
    void changeOnce(Scene& scene, std::vector<bool>& gone, std::mt19937& random) const {
        const auto share = [&] { return static_cast<float>(random()) * 0x1p-32f; };
        const size_t lamp = random() % scene.lights.size(), object = random() % scene.instances.size(),
                     material = random() % scene.materials.size();
        const glm::vec3 way = 0.1f * places_.diagonal * (glm::vec3(share(), share(), share()) - 0.5f);
        Light& light = scene.lights[lamp];
        Material& surface = scene.materials[material];
        switch (random() % 7) {
        case 0:
            light.transform = glm::translate(glm::mat4(1.0f), places_.positions[lamp] + 0.5f * way);
            break;
        case 1:
            light.intensity = home_.lights[lamp].intensity * (0.1f + 1.9f * share());
            light.color = {share(), share(), share()};
            break;
        case 2:
            scene.instances[object].transform =
                glm::translate(glm::mat4(1.0f), way) * home_.instances[object].transform;
            break;
        case 3:
            shiftMesh(scene, object, 0.1f * way);
            break;
        case 4:
            gone[object] = !gone[object] && std::count(gone.begin(), gone.end(), false) > 1;
            break;
        case 5:
            surface.metallic = share();
            surface.roughness = share();
            break;
        default:
            surface.baseColor = {share(), share(), share(), home_.materials[material].baseColor.a};
            break;
        }
    }
    double differenceFromFresh() {
        const std::string shown = folder_.file("shown.exr");
        bake_.exportLightmap(
            {.path = shown, .lightmap = {}, .scene = level_, .surfaces = session_.surfaces()});
        waitFor([&] { return std::filesystem::exists(shown); });
        PreparedScene scene = prepareScene(request_.prepare);
        Baker fresh(device_, scene.scene, std::move(scene.mesh), request_.bake);
        while (!fresh.solver().done()) {
            stopIfInterrupted();
            fresh.solver().step();
        }
        return compareImages(readImage(shown), "shown", fresh.lightmap({}), "fresh").relRmse;
    }

    void describeBake() {
        const BakeStatus status = bake_.status();
        if (!status.layered) throw Error(desc_.scene + ": has no layer for each light: " + status.remark);
        report_ = {.scene = desc_.scene,
                   .device = status.device,
                   .tracer = status.tracer,
                   .size = desc_.size,
                   .patches = status.patches,
                   .lamps = desc_.lamps,
                   .edits = {},
                   .difference = {}};
    }

    const ReloadBenchDesc& desc_;
    const vk::Device device_; // before there is a thread that makes one
    const PassingFolder folder_{std::filesystem::temp_directory_path(), "relume_bench_"};
    std::string level_;
    BakeRequest request_;
    LiveBake bake_;
    MapSink sink_;
    Session session_;
    Scene home_; // as the file has it in the beginning, and between edits
    LampPlaces places_;
    std::optional<uint32_t> material_, object_; // that are edited
    Clock::time_point written_{};               // when the newest edit was made
    uint64_t rays_ = 0;                         // of the bake by then
    uint64_t probes_ = 0;                       // requests
    ReloadReport report_;
};

} // namespace

ReloadReport benchReload(const ReloadBenchDesc& desc) {
    ASSERT(desc.lamps > 0 && desc.runs > 0);
    return ReloadBench(desc, placingOf(desc)).run(); // a scene that cannot be read is told before a device is
}

} // namespace relume
