#include "assets/gltf/edit/gltf_edit_light.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/gltf/edit/gltf_edit_transform.h"
#include "assets/gltf/gltf_light_json.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/model/light_names.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace relume::gltf {

namespace {

constexpr double kHalfPi = 1.57079632679489662;

Carried carriedAs(const Light& light) {
    return isAreaLight(light.type) ? Carried::AreaLight : Carried::Light;
}

/// Tells whether two lights differ at most in their places.
bool alike(const Light& a, const Light& b) {
    return a.name == b.name && a.type == b.type && a.color == b.color && a.intensity == b.intensity &&
           a.range == b.range && a.innerConeAngle == b.innerConeAngle &&
           a.outerConeAngle == b.outerConeAngle && a.radius == b.radius && a.angle == b.angle &&
           a.size == b.size;
}

/// Writes cones of at most a right angle, the inner one inside the outer one, as glTF wants it.
void writeCones(const FileEdit& edit, EditedJson& entry, const Light& light, const Light* before) {
    const std::string where = "light " + inQuotes(light.name);
    const bool opened = !before || before->outerConeAngle != light.outerConeAngle;
    if (opened) {
        EditedJson& outer = make(edit, entry, {"spot", "outerConeAngle"}, where);
        constexpr float kNarrowest = 1e-3f; // [rad], that of the importer; glTF wants more than 0
        setNumber(outer, std::max(light.outerConeAngle, kNarrowest));
        // The float next to a right angle is above it.
        if (outer.get<double>() > kHalfPi) outer = kHalfPi;
    }
    const float below = std::nextafter(light.outerConeAngle, 0.0f);
    if (opened || before->innerConeAngle != light.innerConeAngle)
        setNumber(make(edit, entry, {"spot", "innerConeAngle"}, where),
                  std::min(light.innerConeAngle, below));
}

/// Returns the scale by which EXT_lights_area multiplies the size of a node's light; that of a new node,
/// which has none, is 1.
double scaleOfNode(const NodeTree& tree, int node) {
    if (static_cast<size_t>(node) >= tree.size()) return 1.0;
    const glm::dmat4 world = tree.world(node);
    double largest = 0.0;
    for (int c = 0; c < 3; ++c)
        largest = std::max(largest, glm::length(glm::dvec3(world[c])));
    return largest > 0.0 && std::isfinite(largest) ? largest : 1.0;
}

} // namespace

LightEdit::LightEdit(FileEdit& edit, const NodeTree& tree, const std::string& target)
    : edit_(edit), tree_(tree), target_(target), punctual_(edit, kPunctualLights), area_(edit, kAreaLights) {}

bool LightEdit::holds(int node, bool area) const {
    if (node < 0 || static_cast<size_t>(node) >= tree_.size()) return false;
    if (!area) return punctual_.has(node);
    return hasAreaExtras(node) || area_.has(node);
}

bool LightEdit::hasAreaExtras(int node) const {
    return find(edit_.json["nodes"][static_cast<size_t>(node)], {"extras", "relume", "areaLight"});
}

void LightEdit::requireGood(const Light& light) const {
    const auto require = [&](float value, const char* what) {
        if (!std::isfinite(value) || value < 0.0f)
            throw Error(fmt::format("{}: light {} has {} of {}: give a finite number that is not negative",
                                    target_, inQuotes(light.name), what, value));
    };
    for (int c = 0; c < 3; ++c)
        require(light.color[c], "a colour");
    require(light.intensity, "an intensity");
    require(light.range, "a range");
    require(light.radius, "a radius");
    require(light.angle, "an angle");
    require(light.innerConeAngle, "an inner cone angle");
    require(light.outerConeAngle, "an outer cone angle");
    require(light.size.x, "a width");
    require(light.size.y, "a height");
    if (light.type == LightType::Spot &&
        (light.outerConeAngle > float(kHalfPi) || light.innerConeAngle > light.outerConeAngle))
        throw Error(
            fmt::format("{}: light {} has cones of {} and {} rad: give an inner one that is not above "
                        "the outer one, and that at most 90 degrees",
                        target_, inQuotes(light.name), light.innerConeAngle, light.outerConeAngle));
    for (int i = 0; i < 16; ++i)
        if (!std::isfinite(light.transform[i / 4][i % 4]))
            throw Error(fmt::format("{}: light {} has a position that is not finite: place it again", target_,
                                    inQuotes(light.name)));
}

void LightEdit::writePunctual(EditedJson& entry, const Light& light, const Light* before) const {
    const std::string where = "light " + inQuotes(light.name);
    const bool anew = !before || before->type != light.type;
    if (!before || before->name != light.name) {
        if (light.name.empty()) {
            erase(entry, {"name"});
        } else {
            entry["name"] = light.name;
        }
    }
    if (anew) entry["type"] = lightTypeName(light.type);
    if (!before || before->color != light.color) setNumbers(entry["color"], numbersOf(light.color));
    if (!before || before->intensity != light.intensity) setNumber(entry["intensity"], light.intensity);
    const auto member = [&](const JsonPath& path, float value, bool changed, bool belongs) {
        if (belongs ? value == 0.0f && changed : anew) {
            erase(entry, path);
        } else if (belongs && changed) {
            setNumber(make(edit_, entry, path, where), value);
        }
    };
    const bool sun = light.type == LightType::Directional;
    member({"range"}, light.range, anew || before->range != light.range, !sun);
    member({"extras", "relume", "radius"}, light.radius, anew || before->radius != light.radius, !sun);
    member({"extras", "relume", "angle"}, light.angle, anew || before->angle != light.angle, sun);
    if (light.type == LightType::Spot) {
        writeCones(edit_, entry, light, anew ? nullptr : before);
    } else if (anew) {
        erase(entry, {"spot"});
    }
}

/// Writes an area light into its node's extras, which say it whatever scale the node has, and into its entry
/// of EXT_lights_area. A light that the file has by extras alone stays so.
void LightEdit::writeArea(int index, const Light& light, const Light* before) {
    EditedJson& node = edit_.json["nodes"][static_cast<size_t>(index)];
    const JsonPath path = {"extras", "relume", "areaLight"};
    const bool byExtension = area_.has(index), byExtras = find(node, path) != nullptr;
    if (byExtension) {
        writeAreaExtension(area_.own(index), light, scaleOfNode(tree_, index));
    } else if (!byExtras) {
        EditedJson entry = EditedJson::object();
        writeAreaExtension(entry, light, scaleOfNode(tree_, index));
        area_.add(index, std::move(entry));
    }
    if (!byExtras) before = nullptr;
    EditedJson& area =
        make(edit_, edit_.json["nodes"][static_cast<size_t>(index)], path, fmt::format("nodes[{}]", index));
    if (area.is_null()) area = EditedJson::object();
    const bool anew = !before || before->type != light.type;
    if (!before || before->name != light.name) area["name"] = light.name;
    if (anew) area["type"] = lightTypeName(light.type);
    if (!before || before->color != light.color) setNumbers(area["color"], numbersOf(light.color));
    if (!before || before->intensity != light.intensity) setNumber(area["intensity"], light.intensity);
    if (light.type == LightType::Rectangle) {
        const float size[2] = {light.size.x, light.size.y};
        if (anew || before->size != light.size) setNumbers(area["size"], size);
        if (anew) area.erase("radius");
    } else {
        if (anew || before->radius != light.radius) setNumber(area["radius"], light.radius);
        if (anew) area.erase("size");
    }
}

/// Writes all that an entry of EXT_lights_area says of a light whose node has this scale.
void LightEdit::writeAreaExtension(EditedJson& entry, const Light& light, double scale) const {
    const bool isDisc = light.type == LightType::Disc;
    if (light.name.empty()) {
        erase(entry, {"name"});
    } else {
        entry["name"] = light.name;
    }
    entry["type"] = isDisc ? "disk" : "rect";
    setNumbers(entry["color"], numbersOf(light.color));
    setNumber(entry["intensity"], light.intensity);
    const double height = isDisc ? 2.0 * double(light.radius) : double(light.size.y);
    setNumber(entry["size"], static_cast<float>(height / scale));
    if (isDisc)
        erase(entry, {"rect"});
    else
        setNumber(make(edit_, entry, {"rect", "aspect"}, "light " + inQuotes(light.name)),
                  static_cast<float>(double(light.size.x) / double(light.size.y)));
}

void LightEdit::write(int node, const Light& light, const Light* before) {
    if (isAreaLight(light.type)) {
        writeArea(node, light, before);
    } else if (before) {
        writePunctual(punctual_.own(node), light, before);
    } else {
        EditedJson entry = EditedJson::object();
        writePunctual(entry, light, nullptr);
        punctual_.add(node, std::move(entry));
    }
}

void LightEdit::remove(const Light& light) {
    if (isAreaLight(light.type)) {
        erase(edit_.json["nodes"][static_cast<size_t>(light.node)], {"extras", "relume", "areaLight"});
        area_.remove(light.node);
    } else {
        punctual_.remove(light.node);
    }
    emptied_.push_back(light.node);
}

/// Returns where among the default scene's nodes a new one has to be so that its light comes before those
/// that follow it in the list, as one does that was deleted, saved and brought back. It is the last place
/// where those are in one tree with the lights before it, and for a light that is the last.
size_t LightEdit::rootPlace(const std::vector<int>& nodes, size_t index) const {
    EditedJson* scenes = find(edit_.json, {"scenes"});
    if (!scenes || scenes->empty()) return kLastPlace;
    const EditedJson* roots = find(editedScene(edit_), {"nodes"});
    if (!roots) return kLastPlace;
    const auto placeOf = [&](int node) -> size_t {
        const int root = static_cast<size_t>(node) < tree_.size() ? tree_.root(node) : node;
        return static_cast<size_t>(std::find(roots->begin(), roots->end(), root) - roots->begin());
    };
    const auto isPlaced = [](int node) { return node >= 0; };
    const auto at = nodes.begin() + static_cast<std::ptrdiff_t>(index);
    const auto next = std::find_if(at, nodes.end(), isPlaced);
    if (next == nodes.end()) return kLastPlace;
    const auto last = std::find_if(std::make_reverse_iterator(at), nodes.rend(), isPlaced);
    const size_t place = placeOf(*next);
    return last == nodes.rend() || placeOf(*last) < place ? place : kLastPlace;
}

/// Gives a light that the file lacks a node: the one that it had once, if nothing else took that, else a new
/// one.
int LightEdit::adopt(const Light& light, size_t rootPlace, Moves& moves) {
    const bool known = light.node >= 0 && static_cast<size_t>(light.node) < tree_.size() &&
                       tree_.inScene(light.node) && tree_.isVisible(light.node) &&
                       !holds(light.node, isAreaLight(light.type));
    if (!known) {
        const int node = addNode(edit_, light.name, -1, rootPlace);
        writeRigid(edit_.json["nodes"][static_cast<size_t>(node)], light.transform);
        write(node, light, nullptr);
        return node;
    }
    write(light.node, light, nullptr);
    const glm::mat4 world(tree_.world(light.node));
    if (world != light.transform) moves[light.node][carriedAs(light)] = {light.name, world, light.transform};
    return light.node;
}

std::vector<int> LightEdit::apply(const std::vector<Light>& before, const std::vector<Light>& after,
                                  Moves& moves) {
    std::map<std::pair<int, bool>, const Light*> known;
    for (const Light& light : before) {
        if (!holds(light.node, isAreaLight(light.type)))
            throw Error(fmt::format("{}: has no light {} any more: the file has changed, load it again",
                                    edit_.file.path, inQuotes(light.name)));
        known[{light.node, isAreaLight(light.type)}] = &light;
    }
    std::vector<int> nodes(after.size(), -1);
    for (size_t i = 0; i < after.size(); ++i) {
        const auto found = known.find({after[i].node, isAreaLight(after[i].type)});
        if (found == known.end()) continue; // an added one, or a second one of a node
        const Light& old = *found->second;
        known.erase(found);
        nodes[i] = after[i].node;
        const bool moved = old.transform != after[i].transform, changed = !alike(old, after[i]);
        if (moved || changed) requireGood(after[i]);
        // A move may change its node's scale, which the extension's size follows: then the extras are needed.
        const bool bare = moved && isAreaLight(old.type) && !hasAreaExtras(nodes[i]);
        if (changed || bare) write(nodes[i], after[i], &old);
        if (moved) moves[nodes[i]][carriedAs(old)] = {after[i].name, old.transform, after[i].transform};
    }
    for (const auto& [key, light] : known)
        remove(*light);
    for (size_t i = 0; i < after.size(); ++i) {
        if (nodes[i] >= 0) continue;
        requireGood(after[i]);
        nodes[i] = adopt(after[i], rootPlace(nodes, i), moves);
    }
    return nodes;
}

} // namespace relume::gltf
