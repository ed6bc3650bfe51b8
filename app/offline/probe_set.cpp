#include "app/offline/probe_set.h"

#include "app/offline/light_mix.h"
#include "app/offline/name_lines.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

// Returns the number that has the same text as the float, in place of a dozen more digits.
double shortNumber(float v) {
    return std::stod(fmt::format("{}", v));
}

Json triple(const glm::vec3& v) {
    return {shortNumber(v.x), shortNumber(v.y), shortNumber(v.z)};
}

// The numbers are most of the text, so they are written with no more digits than light has that is known to a
// thousandth, and to spare.
std::string coefficientsText(const Harmonics& harmonics) {
    std::string text = "[";
    for (const glm::dvec3& c : harmonics)
        text += fmt::format("{}[{:.7g}, {:.7g}, {:.7g}]", text.size() > 1 ? ", " : "", c.x, c.y, c.z);
    return text + "]";
}

Json layerHead(const LayeredImage::Layer& light) {
    Json head = {{"name", light.name}, {"weight", triple(light.weight)}};
    for (const auto& [key, name] :
         {std::pair{layer_attribute::kType, "type"}, std::pair{layer_attribute::kUnit, "unit"},
          std::pair{layer_attribute::kStale, "stale"}})
        if (const auto found = light.attributes.find(key); found != light.attributes.end())
            head[name] = found->second;
    head["intensity"] = shortNumber(intensityOf(light));
    head["color"] = triple(colorOf(light));
    if (const std::vector<std::string> members = membersOf(light); !members.empty())
        head["members"] = members;
    return head;
}

// Returns the text of JSON in one line. Names that are no UTF-8 get marks in place of odd bytes.
std::string textOf(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Returns an object's text without its closing brace, to which a member is to be added.
std::string opened(const Json& object) {
    std::string text = textOf(object);
    text.pop_back();
    return text;
}

// Reads values, and names the file where one is not as it must be.
class ProbeReader {
public:
    explicit ProbeReader(const std::string& path) : path_(path) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}: take a file that 'relume bake --probes-out' wrote", path_, what));
    }
    const Json& member(const Json& object, const char* name, const std::string& of) const {
        if (!object.is_object() || !object.contains(name)) fail(fmt::format("{} has no '{}'", of, name));
        return object[name];
    }
    const Json& list(const Json& object, const char* name, const std::string& of) const {
        const Json& found = member(object, name, of);
        if (!found.is_array()) fail(fmt::format("'{}' of {} is no list", name, of));
        return found;
    }
    double number(const Json& value, const std::string& what) const {
        if (!value.is_number() || !(std::abs(value.get<double>()) <= kLargest))
            fail(what + " is no number that light or a place can have");
        return value.get<double>();
    }
    glm::dvec3 vector(const Json& value, const std::string& what) const {
        if (!value.is_array() || value.size() != 3) fail(what + " is not three numbers");
        return {number(value[0], what), number(value[1], what), number(value[2], what)};
    }
    std::string text(const Json& value, const std::string& what) const {
        if (!value.is_string()) fail(what + " is no text");
        return value.get<std::string>();
    }
    Harmonics harmonics(const Json& value, const std::string& what) const {
        Harmonics result{};
        if (!value.is_array() || value.size() != result.size())
            fail(fmt::format("{} are not {} coefficients", what, result.size()));
        for (size_t i = 0; i < result.size(); ++i)
            result[i] = vector(value[i], what);
        return result;
    }

private:
    static constexpr double kLargest = 1e30;
    const std::string& path_;
};

ProbeGrid gridOf(const ProbeReader& reader, const Json& json) {
    ProbeGrid grid;
    grid.first = reader.vector(reader.member(json, "first", "the grid"), "'first' of the grid");
    const double spacing = reader.number(reader.member(json, "spacing", "the grid"), "'spacing' of the grid");
    if (!(spacing > 0)) reader.fail("'spacing' of the grid is not above 0");
    grid.spacing = static_cast<float>(spacing);
    const glm::dvec3 counts =
        reader.vector(reader.member(json, "counts", "the grid"), "'counts' of the grid");
    for (int axis = 0; axis < 3; ++axis) {
        if (!(counts[axis] >= 1 && counts[axis] <= kMostProbes) || counts[axis] != std::floor(counts[axis]))
            reader.fail(fmt::format("'counts' of the grid are not whole numbers from 1 to {}", kMostProbes));
        grid.counts[axis] = static_cast<uint32_t>(counts[axis]);
    }
    return grid;
}

Probe probeOf(const ProbeReader& reader, const Json& json, const std::string& name) {
    Probe probe;
    probe.position = reader.vector(reader.member(json, "position", name), "'position' of " + name);
    probe.backs = reader.number(reader.member(json, "backs", name), "'backs' of " + name);
    probe.radiance = reader.harmonics(reader.member(json, "coefficients", name), "'coefficients' of " + name);
    return probe;
}

ProbeSet::Layer probeLayerOf(const ProbeReader& reader, const Json& json, size_t probes) {
    ProbeSet::Layer layer;
    layer.light.name = reader.text(reader.member(json, "name", "a layer"), "'name' of a layer");
    const std::string name = "layer " + inQuotes(layer.light.name);
    layer.light.weight = reader.vector(reader.member(json, "weight", name), "'weight' of " + name);
    auto& attributes = layer.light.attributes;
    for (const auto& [key, member] :
         {std::pair{layer_attribute::kType, "type"}, std::pair{layer_attribute::kUnit, "unit"},
          std::pair{layer_attribute::kStale, "stale"}})
        if (json.contains(member))
            attributes[key] = reader.text(json[member], fmt::format("'{}' of {}", member, name));
    attributes[layer_attribute::kIntensity] = fmt::format(
        "{}",
        static_cast<float>(reader.number(reader.member(json, "intensity", name), "'intensity' of " + name)));
    const glm::vec3 color = reader.vector(reader.member(json, "color", name), "'color' of " + name);
    attributes[layer_attribute::kColor] = fmt::format("{},{},{}", color.r, color.g, color.b);
    if (json.contains("members")) {
        std::vector<std::string> members;
        for (const Json& member : reader.list(json, "members", name))
            members.push_back(reader.text(member, "a member of " + name));
        attributes[layer_attribute::kMembers] = joinedLines(members);
    }
    const Json& all = reader.list(json, "coefficients", name);
    if (all.size() != probes)
        reader.fail(fmt::format("{} has coefficients for {} probes of {}", name, all.size(), probes));
    for (const Json& one : all)
        layer.radiance.push_back(reader.harmonics(one, "'coefficients' of " + name));
    return layer;
}

} // namespace

void sumLayers(ProbeSet& set) {
    for (size_t p = 0; p < set.probes.size(); ++p) {
        Harmonics sum{};
        for (const ProbeSet::Layer& layer : set.layers)
            for (size_t i = 0; i < sum.size(); ++i)
                sum[i] += glm::dvec3(layer.light.weight) * layer.radiance[p][i];
        set.probes[p].radiance = sum;
    }
}

void weighLike(ProbeSet& set, const LayeredImage& image) {
    if (set.layers.empty())
        throw Error("the probes have no layers: bake them with 'relume bake --layers --probes'");
    for (ProbeSet::Layer& layer : set.layers) {
        const auto same = [&](const LayeredImage::Layer& other) { return other.name == layer.light.name; };
        const auto found = std::find_if(image.layers.begin(), image.layers.end(), same);
        if (found == image.layers.end())
            throw Error(
                fmt::format("the lightmap has no light {}, which the probes have: bake both in one go",
                            inQuotes(layer.light.name)));
        layer.light = {found->name, found->weight, found->attributes, {}};
    }
    for (const LayeredImage::Layer& other : image.layers) {
        const auto same = [&](const ProbeSet::Layer& layer) { return layer.light.name == other.name; };
        if (std::none_of(set.layers.begin(), set.layers.end(), same))
            throw Error(
                fmt::format("the probes have no light {}, which the lightmap has: bake both in one go",
                            inQuotes(other.name)));
    }
    sumLayers(set);
}

void requireFiniteLight(const Harmonics& radiance, const std::string& path) {
    for (const glm::dvec3& c : radiance)
        if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z))
            throw Error(path + ": a probe's light is not finite: make the lights of the scene darker");
}

std::string probesJson(const ProbeSet& set, const std::string& path) {
    std::string text =
        opened({{"version", RELUME_VERSION},
                {"quantity", "radiance"},
                {"unit", "cd/m^2"},
                {"basis", "real spherical harmonics, bands 0 to 2: 1, y, z, x, xy, yz, 3z^2-1, xz, "
                          "x^2-y^2, orthonormal, Y up"}});
    if (set.grid) {
        const glm::uvec3& n = set.grid->counts;
        const Json grid = {{"first", triple(set.grid->first)},
                           {"spacing", shortNumber(set.grid->spacing)},
                           {"counts", {n.x, n.y, n.z}},
                           {"order", "x fastest, then y, then z"}};
        text += ",\n\"grid\":" + textOf(grid);
    }
    text += ",\n\"probes\":[";
    for (size_t p = 0; p < set.probes.size(); ++p) {
        const Probe& probe = set.probes[p];
        requireFiniteLight(probe.radiance, path);
        const Json head = {
            {"position", triple(probe.position)}, {"inside", probe.inside()}, {"backs", probe.backs}};
        text += p > 0 ? ",\n " : "\n ";
        text += opened(head);
        text += ",\"coefficients\":" + coefficientsText(probe.radiance) + "}";
    }
    text += "\n]";
    if (!set.layers.empty()) text += ",\n\"layers\":[";
    for (size_t l = 0; l < set.layers.size(); ++l) {
        const ProbeSet::Layer& layer = set.layers[l];
        text += l > 0 ? ",\n " : "\n ";
        text += opened(layerHead(layer.light));
        text += ",\"coefficients\":[";
        for (size_t p = 0; p < layer.radiance.size(); ++p) {
            requireFiniteLight(layer.radiance[p], path);
            text += p > 0 ? ",\n  " : "\n  ";
            text += coefficientsText(layer.radiance[p]);
        }
        text += "\n ]}";
    }
    text += set.layers.empty() ? "}\n" : "\n]}\n";
    return text;
}

ProbeSet parseProbes(const std::string& text, const std::string& path) {
    const ProbeReader reader(path);
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) reader.fail("is no JSON");
    ProbeSet set;
    const Json& probes = reader.list(json, "probes", "the file");
    if (probes.empty() || probes.size() > kMostProbes)
        reader.fail(fmt::format("it has {} probes, not 1 to {}", probes.size(), kMostProbes));
    if (json.contains("grid")) {
        set.grid = gridOf(reader, json["grid"]);
        const glm::u64vec3 n = set.grid->counts;
        if (n.x * n.y * n.z != probes.size())
            reader.fail(fmt::format("its grid is not one of {} probes", probes.size()));
    }
    for (size_t p = 0; p < probes.size(); ++p)
        set.probes.push_back(probeOf(reader, probes[p], fmt::format("probe {}", p)));
    if (json.contains("layers"))
        for (const Json& layer : reader.list(json, "layers", "the file"))
            set.layers.push_back(probeLayerOf(reader, layer, probes.size()));
    return set;
}

} // namespace relume
