#include "app/offline/probe_forms.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

size_t indexIn(const ProbeGrid& grid, const glm::ivec3& at) {
    const glm::u64vec3 n = grid.counts, p = at;
    return (p.z * n.y + p.y) * n.x + p.x;
}

// Returns the mean of those neighbours along the axes that are known.
std::optional<Harmonics> meanAround(const ProbeGrid& grid, const glm::ivec3& at,
                                    const std::vector<uint8_t>& known,
                                    const std::vector<Harmonics>& radiance) {
    Harmonics sum{};
    double count = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
            glm::ivec3 beside = at;
            beside[axis] += step;
            if (beside[axis] < 0 || beside[axis] >= static_cast<int>(grid.counts[axis])) continue;
            const size_t index = indexIn(grid, beside);
            if (known[index] == 0) continue;
            for (size_t i = 0; i < sum.size(); ++i)
                sum[i] += radiance[index][i];
            ++count;
        }
    if (count == 0) return std::nullopt;
    for (glm::dvec3& c : sum)
        c /= count;
    return sum;
}

template<typename F>
void forEachPlace(const ProbeGrid& grid, const F& f) {
    const glm::ivec3 n = grid.counts;
    for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y)
            for (int x = 0; x < n.x; ++x)
                f(glm::ivec3(x, y, z));
}

} // namespace

std::vector<Harmonics> freeRadiance(const ProbeGrid& grid, const std::vector<Probe>& probes) {
    std::vector<Harmonics> radiance;
    std::vector<uint8_t> known;
    for (const Probe& probe : probes) {
        radiance.push_back(probe.radiance);
        known.push_back(probe.inside() ? 0 : 1);
    }
    for (bool goesOn = true; goesOn;) {
        const std::vector<uint8_t> before = known;
        std::vector<Harmonics> next = radiance;
        goesOn = false;
        forEachPlace(grid, [&](const glm::ivec3& at) {
            const size_t index = indexIn(grid, at);
            if (before[index] != 0) return;
            const std::optional<Harmonics> mean = meanAround(grid, at, before, radiance);
            if (!mean) return;
            next[index] = *mean;
            known[index] = 1;
            goesOn = true;
        });
        radiance = std::move(next);
    }
    return radiance;
}

std::string volumeProblem(const ProbeGrid& grid) {
    constexpr uint32_t kMostTexels = 2048; // along each edge of a 3D texture, which every device has [WebGPU]
    const glm::uvec3 texels = grid.counts * glm::uvec3(1, 2, 3);
    if (texels.x <= kMostTexels && texels.y <= kMostTexels && texels.z <= kMostTexels) return "";
    return fmt::format("its volume of {} x {} x {} texels has an edge above {}: take a wider grid, or .json",
                       texels.x, texels.y, texels.z, kMostTexels);
}

FloatImage ambientCubes(const ProbeGrid& grid, const std::vector<Probe>& probes) {
    const std::vector<Harmonics> radiance = freeRadiance(grid, probes);
    const glm::u64vec3 n = grid.counts;
    FloatImage image;
    image.width = grid.counts.x;
    image.height = 2 * grid.counts.y * 3 * grid.counts.z;
    for (const char* channel : {"R", "G", "B"})
        image.add(channel);
    forEachPlace(grid, [&](const glm::ivec3& at) {
        const glm::u64vec3 p = at;
        for (int axis = 0; axis < 3; ++axis)
            for (const bool negative : {false, true}) {
                glm::dvec3 normal(0.0);
                normal[axis] = negative ? -1.0 : 1.0;
                const glm::dvec3 lighting =
                    glm::max(irradiance(radiance[indexIn(grid, at)], normal), 0.0) / std::numbers::pi;
                const size_t slice = static_cast<size_t>(axis) * n.z + p.z;
                const size_t row = slice * 2 * n.y + p.y + (negative ? n.y : 0);
                for (int c = 0; c < 3; ++c)
                    image.planes[static_cast<size_t>(c)][row * n.x + p.x] = static_cast<float>(lighting[c]);
            }
    });
    return image;
}

std::string threeProbes(const ProbeSet& set, const std::string& path) {
    using Json = nlohmann::ordered_json;
    const auto uuid = [](size_t number) { return fmt::format("00000000-0000-4000-8000-{:012x}", number); };
    std::string text = R"({"metadata":{"version":4.6,"type":"Object","generator":"Relume"},)";
    text += "\n\"object\":{\"uuid\":\"" + uuid(0) + R"(","type":"Group","name":"light probes",)";
    if (set.grid) {
        const glm::vec3& first = set.grid->first;
        text += fmt::format(
            "\"userData\":{{\"grid\":{{\"first\":[{},{},{}],\"spacing\":{},\"counts\":[{},{},{}]}}}},",
            first.x, first.y, first.z, set.grid->spacing, set.grid->counts.x, set.grid->counts.y,
            set.grid->counts.z);
    }
    text += "\"children\":[";
    for (size_t p = 0; p < set.probes.size(); ++p) {
        const Probe& probe = set.probes[p];
        requireFiniteLight(probe.radiance, path);
        std::string numbers;
        for (const glm::dvec3& c : probe.radiance)
            numbers += fmt::format("{}{:.7g},{:.7g},{:.7g}", numbers.empty() ? "" : ",", c.x, c.y, c.z);
        text += fmt::format("{}{{\"uuid\":\"{}\",\"type\":\"LightProbe\",\"name\":\"probe {}\",\"matrix\":"
                            "[1,0,0,0,0,1,0,0,0,0,1,0,{},{},{},1],\"userData\":{{\"inside\":{}}},"
                            "\"intensity\":1,\"sh\":[{}]}}",
                            p > 0 ? ",\n " : "\n ", uuid(p + 1), p, probe.position.x, probe.position.y,
                            probe.position.z, probe.inside() ? "true" : "false", numbers);
    }
    text += "\n]}}\n";
    ASSERT(Json::accept(text));
    return text;
}

} // namespace relume
