#include "app/offline/probe_bake.h"

#include "app/offline/layer_file.h"
#include "assets/base/log.h"
#include "bake/layers/layer_solver.h"

#include <algorithm>
#include <functional>

namespace relume {
namespace {

// The lights that are told apart: each is made when its turn comes, for its radiance takes memory.
using Lights = std::vector<std::function<ProbeLight()>>;

// Returns the lights of a layer that shines with a weight of 1: a group's weights are its members'.
std::vector<LightSource> unitSources(const Layer& layer) {
    if (!layer.members.empty()) return layer.members;
    LightSource unit = layer.source;
    unit.weight = glm::vec3(1.0f);
    return {unit};
}

class ProbeBake {
public:
    ProbeBake(const vk::Device& device, const Scene& scene, Baker& baker, float reflectivity)
        : device_(device), scene_(scene), baker_(baker), reflectivity_(reflectivity) {}

    ProbeSet run(const ProbePlan& plan, uint32_t samples) {
        ProbeSet set;
        if (plan.isGrid) set.grid = plan.grid;
        for (const glm::vec3& point : plan.points)
            set.probes.push_back({.position = point});
        spdlog::info("light probes: {} to trace", set.probes.size());
        const Lights lights = baker_.layers() ? layerLights(set) : allLight();
        std::vector<std::vector<Harmonics>> harmonics(lights.size());
        ProbeTracer tracer(device_, baker_.patches(), probeLamps(scene_, baker_.patches().scene.mesh),
                           plan.points, parseTracerKind(baker_.tracer().name()));
        const size_t atOnce = probeLightsAtOnce(baker_.patches().albedo.size());
        for (size_t first = 0; first == 0 || first < lights.size(); first += atOnce)
            bakeLights(set, tracer, samples, lights, first, std::min(lights.size(), first + atOnce),
                       harmonics);
        keep(set, std::move(harmonics));
        return set;
    }
    uint64_t rays() const { return rays_; }

private:
    Lights allLight() {
        return {[this] {
            return probeLight(scene_, baker_.patches(), lightSources(scene_), baker_.solver().light(),
                              reflectivity_);
        }};
    }

    // A layer that has no light, because it is off, gives none.
    Lights layerLights(ProbeSet& set) {
        Lights lights;
        for (const std::unique_ptr<Layer>& layer : baker_.layers()->layers()) {
            set.layers.push_back({layerWithoutImage(scene_, *layer), {}});
            lights.push_back([this, &layer] {
                const Layer* shown = layer->shown();
                return probeLight(scene_, baker_.patches(),
                                  shown ? unitSources(*layer) : std::vector<LightSource>(),
                                  baker_.layers()->layerLight(shown ? *shown : *layer), reflectivity_);
            });
        }
        return lights;
    }

    // Returns which share of the work is done when this one of the lights under way is.
    static double shareOf(size_t first, size_t end, size_t lights, double done) {
        const double all = std::max<double>(static_cast<double>(lights), 1.0);
        return (static_cast<double>(first) + done * static_cast<double>(end - first)) / all;
    }

    void bakeLights(ProbeSet& set, ProbeTracer& tracer, uint32_t samples, const Lights& lights, size_t first,
                    size_t end, std::vector<std::vector<Harmonics>>& harmonics) {
        std::vector<ProbeLight> made;
        for (size_t l = first; l < end; ++l)
            made.push_back(lights[l]());
        const auto count = static_cast<uint32_t>(set.probes.size());
        const uint32_t batch = probeBatch(samples);
        for (uint32_t p = 0; p < count; p += batch) {
            const ProbeLinks links = tracer.trace(p, std::min(batch, count - p), samples);
            rays_ += links.rays;
            const std::vector<std::vector<Harmonics>> some = gatherProbes(
                device_.workers(), links, made,
                shareOf(first, end, lights.size(), static_cast<double>(p) / static_cast<double>(count)));
            for (size_t l = first; l < end; ++l)
                harmonics[l].insert(harmonics[l].end(), some[l - first].begin(), some[l - first].end());
            if (first > 0) continue;
            const std::vector<double> backs = probeBacks(device_.workers(), links);
            for (size_t i = 0; i < backs.size(); ++i)
                set.probes[p + i].backs = backs[i];
        }
    }

    void keep(ProbeSet& set, std::vector<std::vector<Harmonics>> harmonics) const {
        if (!baker_.layers()) {
            for (size_t p = 0; p < set.probes.size(); ++p)
                set.probes[p].radiance = harmonics[0][p];
            return;
        }
        for (size_t l = 0; l < set.layers.size(); ++l)
            set.layers[l].radiance = std::move(harmonics[l]);
        sumLayers(set);
    }

    const vk::Device& device_;
    const Scene& scene_;
    Baker& baker_;
    float reflectivity_;
    uint64_t rays_ = 0;
};

} // namespace

ProbeSet bakeProbes(const vk::Device& device, const Scene& scene, Baker& baker, const ProbePlan& plan,
                    uint32_t samples, float reflectivity) {
    ProbeBake bake(device, scene, baker, reflectivity);
    ProbeSet set = bake.run(plan, samples);
    const auto inside = std::count_if(set.probes.begin(), set.probes.end(),
                                      [](const Probe& probe) { return probe.inside(); });
    spdlog::info("{} probes, {} of them inside walls, {:.3g} Mrays", set.probes.size(), inside,
                 static_cast<double>(bake.rays()) * 1e-6);
    return set;
}

} // namespace relume
