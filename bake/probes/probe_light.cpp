#include "bake/probes/probe_light.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "bake/probes/probe_lamps.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

namespace relume {
namespace shader {
#include "shaders/lib/light/sky_place.glsl"
} // namespace shader

namespace {

using shader::Lamp;

glm::vec3 skyRadiance(const ProbeLight& light, const glm::vec3& direction) {
    const Sky& sky = *light.sky;
    if (sky.pixels.empty()) return light.skyRadiance;
    const glm::vec2 place = shader::skyPlace(direction, sky.rotation);
    const uint32_t row =
        std::min(static_cast<uint32_t>(place.y * static_cast<float>(sky.height)), sky.height - 1);
    const uint32_t column =
        std::min(static_cast<uint32_t>(place.x * static_cast<float>(sky.width)), sky.width - 1);
    return light.skyRadiance * sky.pixels[size_t{row} * sky.width + column];
}

// One probe, light by light; each direction is drawn once for all of them.
class ProbeSums {
public:
    ProbeSums(const ProbeLinks& links, std::span<const ProbeLight> lights, size_t probe)
        : links_(links), lights_(lights), probe_(probe), number_(links.first + static_cast<uint32_t>(probe)),
          sums_(lights.size()) {
        addLinks();
        addLamps();
    }
    const Harmonics& of(size_t light) const { return sums_[light]; }

private:
    void addLinks() {
        const uint32_t* link = links_.linksOf(probe_);
        for (uint32_t face = 0; face < kProbeFaces; ++face)
            for (uint32_t k = 0; k < links_.samples; ++k, ++link) {
                const bool isSky = shader::linkIsSky(*link);
                if (*link >= shader::kLinkFirstSpecial && !isSky) continue;
                const glm::vec3 d = probeDirection(number_, face, k);
                const double solidAngle = probeSolidAngle(d, links_.samples);
                const std::array<double, 9> values = harmonicsAt(d);
                for (size_t l = 0; l < lights_.size(); ++l) {
                    const ProbeLight& light = lights_[l];
                    if (isSky && !light.sky) continue;
                    const glm::vec3 seen = isSky ? skyRadiance(light, d) : glm::vec3(light.radiance[*link]);
                    add(l, values, solidAngle * glm::dvec3(seen));
                }
            }
    }

    void addLamps() {
        uint32_t target = 0;
        for (size_t n = 0; n < links_.lamps.size(); ++n) {
            const Lamp& lamp = links_.lamps[n];
            for (uint32_t k = 0; k < lamp.samples; ++k, ++target) {
                if (!links_.seen[probe_ * links_.targets + target]) continue;
                // A ray's length plays no part in its light.
                const ProbeLampRay ray = sampleProbeLamp(lamp, links_.points[probe_], number_, k, 1.0f);
                const std::array<double, 9> values = harmonicsAt(ray.direction);
                for (size_t l = 0; l < lights_.size(); ++l)
                    if (lights_[l].lamps[n] != glm::vec3(0.0f))
                        add(l, values, double{ray.lux} / lamp.samples * glm::dvec3(lights_[l].lamps[n]));
            }
        }
    }

    void add(size_t light, const std::array<double, 9>& values, const glm::dvec3& seen) {
        for (size_t i = 0; i < values.size(); ++i)
            sums_[light][i] += values[i] * seen;
    }

    const ProbeLinks& links_;
    std::span<const ProbeLight> lights_;
    size_t probe_;
    uint32_t number_;
    std::vector<Harmonics> sums_;
};

// The weights of mesh lights, by instance and material.
using EmitterWeights = std::map<std::pair<uint32_t, uint32_t>, glm::vec3>;

// Adds what mesh lights send by themselves.
void addEmission(const PatchSet& patches, const EmitterWeights& weights, std::vector<glm::vec4>& radiance) {
    std::pair<uint32_t, uint32_t> last(~0u, ~0u);
    glm::vec4 weight(0.0f);
    for (size_t i = 0; i < radiance.size(); ++i) {
        // Patches of one chart follow each other, so the last answer mostly holds.
        const std::pair<uint32_t, uint32_t> key(patches.instance[i], patches.material[i]);
        if (key != last) {
            const auto found = weights.find(key);
            weight = found == weights.end() ? glm::vec4(0.0f) : glm::vec4(found->second, 0.0f);
            last = key;
        }
        radiance[i] += weight * patches.emissionPattern[i];
    }
}

} // namespace

ProbeLight probeLight(const Scene& scene, const PatchSet& patches, std::span<const LightSource> sources,
                      std::span<const glm::vec4> lighting, float reflectivity) {
    ASSERT(lighting.size() == patches.albedo.size());
    ProbeLight light;
    light.lamps.resize(scene.lights.size(), glm::vec3(0.0f));
    EmitterWeights emitters;
    for (const LightSource& source : sources) {
        switch (source.key.kind) {
        case LightKey::Kind::Emitter:
            emitters[{source.key.index, source.key.material}] = source.weight;
            break;
        case LightKey::Kind::Lamp:
            light.lamps[source.key.index] = source.weight;
            break;
        case LightKey::Kind::Sky:
            light.sky = &scene.sky;
            light.skyRadiance = source.weight;
            break;
        case LightKey::Kind::Group:
            ASSERT(false); // its members are asked for
        }
    }
    light.radiance.resize(lighting.size());
    for (size_t i = 0; i < lighting.size(); ++i)
        light.radiance[i] = reflectivity * patches.albedo[i] * lighting[i];
    if (!emitters.empty()) addEmission(patches, emitters, light.radiance);
    return light;
}

std::vector<std::vector<Harmonics>> gatherProbes(WorkerPool& pool, const ProbeLinks& links,
                                                 std::span<const ProbeLight> lights, double done) {
    const auto count = static_cast<uint32_t>(links.points.size());
    std::vector<std::vector<Harmonics>> result(lights.size(), std::vector<Harmonics>(count));
    // A stop is heard between some probes, which take a few hundredths of a second.
    const uint32_t step = 4 * pool.size();
    for (uint32_t first = 0; first < count; first += step) {
        tellWatch("light probes", done);
        pool.run(std::min(step, count - first), [&](uint32_t i) {
            const ProbeSums sums(links, lights, first + i);
            for (size_t l = 0; l < lights.size(); ++l)
                result[l][first + i] = sums.of(l);
        });
    }
    return result;
}

std::vector<double> probeBacks(WorkerPool& pool, const ProbeLinks& links) {
    std::vector<double> backs(links.points.size());
    pool.run(static_cast<uint32_t>(backs.size()), [&](uint32_t probe) {
        const uint32_t* link = links.linksOf(probe);
        for (uint32_t face = 0; face < kProbeFaces; ++face)
            for (uint32_t k = 0; k < links.samples; ++k, ++link)
                if (*link == shader::kLinkBack)
                    backs[probe] +=
                        probeSolidAngle(probeDirection(links.first + probe, face, k), links.samples) /
                        (4.0 * std::numbers::pi);
    });
    return backs;
}

size_t probeLightsAtOnce(uint64_t patches) {
    constexpr uint64_t kRadianceBytes = 256u << 20;
    return std::max<uint64_t>(kRadianceBytes / (std::max<uint64_t>(patches, 1) * sizeof(glm::vec4)), 1);
}

} // namespace relume
