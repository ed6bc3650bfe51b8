#include "app/live/reload.h"

#include "bake/surface/repaint.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace relume {
namespace {

template<typename Named>
bool haveSameNames(const std::vector<Named>& a, const std::vector<Named>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Named& x, const Named& y) { return x.name == y.name; });
}

// Returns the numbers of the names that stand once.
template<typename Named>
std::map<std::string, size_t> numbersByName(const std::vector<Named>& all) {
    std::map<std::string, size_t> numbers, times;
    for (size_t i = 0; i < all.size(); ++i) {
        numbers[all[i].name] = i;
        ++times[all[i].name];
    }
    std::erase_if(numbers, [&](const auto& entry) { return entry.first.empty() || times[entry.first] > 1; });
    return numbers;
}

// Returns which of `others` each of `all` is, by number.
template<typename Named>
std::vector<std::optional<size_t>> counterparts(const std::vector<Named>& all,
                                                const std::vector<Named>& others) {
    std::vector<std::optional<size_t>> out(all.size());
    const bool byNumber = haveSameNames(all, others);
    const auto own = numbersByName(all), other = numbersByName(others);
    for (size_t i = 0; i < all.size(); ++i) {
        if (byNumber) {
            out[i] = i;
            continue;
        }
        const auto found = other.find(all[i].name);
        if (found != other.end() && own.contains(all[i].name)) out[i] = found->second;
    }
    return out;
}

// Returns how many of two lists of things of one name are alike, each counted once. What follows the last
// find is looked at first: mostly the order is the same.
template<typename Named, typename Same>
size_t countAlike(const std::vector<const Named*>& before, const std::vector<const Named*>& after,
                  const Same& same) {
    std::vector<bool> used(before.size(), false);
    size_t alike = 0, next = 0;
    for (const Named* thing : after)
        for (size_t k = 0; k < before.size(); ++k) {
            const size_t i = (next + k) % before.size();
            if (used[i] || !same(*before[i], *thing)) continue;
            used[i] = true;
            next = i + 1;
            ++alike;
            break;
        }
    return alike;
}

// Counts what differs, and what only one of both has. In lists of other names than before, things that share
// a name are told apart by what they are.
template<typename Named, typename Same>
size_t countDifferent(const std::vector<Named>& before, const std::vector<Named>& after, const Same& same) {
    size_t different = 0;
    if (haveSameNames(before, after)) {
        for (size_t i = 0; i < after.size(); ++i)
            different += !same(before[i], after[i]);
        return different;
    }
    std::map<std::string, std::array<std::vector<const Named*>, 2>> byName;
    for (const Named& thing : before)
        byName[thing.name][0].push_back(&thing);
    for (const Named& thing : after)
        byName[thing.name][1].push_back(&thing);
    for (const auto& [name, things] : byName)
        different += std::max(things[0].size(), things[1].size()) - countAlike(things[0], things[1], same);
    return different;
}

// The node is a number in the file, which says nothing of the light.
bool sameLight(const Light& a, Light b) {
    b.node = a.node;
    return a == b;
}

bool sameUse(const TextureRef& a, const TextureRef& b) {
    return a.texture == b.texture && a.texCoord == b.texCoord && a.transform == b.transform;
}

bool sameColours(const Material& a, const Material& b) {
    return a.baseColor == b.baseColor && a.emission == b.emission;
}

// Tells whether an edit could make the one of the other: all but colours and name is the same.
bool sameSurface(const Material& a, const Material& b) {
    return sameUse(a.baseColorTexture, b.baseColorTexture) && sameUse(a.emissionTexture, b.emissionTexture) &&
           sameUse(a.metallicRoughnessTexture, b.metallicRoughnessTexture) && a.metallic == b.metallic &&
           a.roughness == b.roughness && a.alphaMode == b.alphaMode && a.alphaCutoff == b.alphaCutoff &&
           a.doubleSided == b.doubleSided && a.transmission == b.transmission && a.pane == b.pane;
}

bool sameCorners(const Primitive& a, const Primitive& b) {
    return a.movedUvs == b.movedUvs && a.indices == b.indices && a.positions == b.positions &&
           a.normals == b.normals && a.texCoord0 == b.texCoord0 && a.texCoord1 == b.texCoord1 &&
           a.texCoord2 == b.texCoord2 && a.colors == b.colors;
}

bool sameTriangles(const Mesh& a, const Mesh& b) {
    return std::equal(
        a.primitives.begin(), a.primitives.end(), b.primitives.begin(), b.primitives.end(),
        [](const Primitive& x, const Primitive& y) { return x.material == y.material && sameCorners(x, y); });
}

// Tells whether a person would call two meshes the same: their materials may have other numbers, as where
// another object came before them in the file.
bool sameMesh(const Scene& before, const Mesh& a, const Scene& after, const Mesh& b) {
    const auto name = [](const Scene& scene, int material) {
        return material < 0 ? "" : scene.materials[static_cast<size_t>(material)].name;
    };
    return std::equal(a.primitives.begin(), a.primitives.end(), b.primitives.begin(), b.primitives.end(),
                      [&](const Primitive& x, const Primitive& y) {
                          return name(before, x.material) == name(after, y.material) && sameCorners(x, y);
                      });
}

bool samePixels(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.rgba == b.rgba;
}

bool samePictures(const Scene& a, const Scene& b) {
    const auto texture = [](const Texture& x, const Texture& y) {
        return x.image == y.image && x.wrapS == y.wrapS && x.wrapT == y.wrapT && x.nearest == y.nearest;
    };
    return std::equal(a.images.begin(), a.images.end(), b.images.begin(), b.images.end(), samePixels) &&
           std::equal(a.textures.begin(), a.textures.end(), b.textures.begin(), b.textures.end(), texture);
}

bool sameAtlas(const LightmapAtlas& a, const LightmapAtlas& b) {
    return a.repacked == b.repacked && a.pages == b.pages &&
           std::equal(a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(),
                      [](const AtlasRect& x, const AtlasRect& y) {
                          return x.scale == y.scale && x.offset == y.offset && x.texCoord == y.texCoord &&
                                 x.page == y.page;
                      });
}

bool sameSurfaces(const PreparedScene& before, const PreparedScene& after) {
    const Scene &a = before.scene, &b = after.scene;
    const auto object = [](const Instance& x, const Instance& y) { return x.mesh == y.mesh; };
    const auto serves = [&](const Material& x, const Material& y) { return servesPatches({a, x}, {b, y}); };
    return before.size == after.size && sameAtlas(before.atlas, after.atlas) &&
           a.sky.pixels == b.sky.pixels && a.sky.file == b.sky.file &&
           std::equal(a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(),
                      object) &&
           std::equal(a.materials.begin(), a.materials.end(), b.materials.begin(), b.materials.end(),
                      serves) &&
           std::equal(a.meshes.begin(), a.meshes.end(), b.meshes.begin(), b.meshes.end(), sameTriangles);
}

// Tells whether all surfaces are painted alike, but for colours.
bool samePaint(const Scene& a, const Scene& b) {
    return samePictures(a, b) && std::equal(a.materials.begin(), a.materials.end(), b.materials.begin(),
                                            b.materials.end(), sameSurface);
}

std::vector<Light> withoutPreview(std::vector<Light> lights) {
    std::erase_if(lights, [](const Light& light) { return light.preview; });
    return lights;
}

/// Merges values of one scene three ways, and notes where both sides changed one.
class Merge {
public:
    template<typename Value>
    Value value(const Value& before, const Value& own, const Value& after, const std::string& name) {
        if (own == before) return after;
        if (after != before && after != own) tell(name + ": was edited here and in the file: the edit stays");
        return own;
    }
    void tell(const std::string& conflict) {
        if (std::find(conflicts_.begin(), conflicts_.end(), conflict) == conflicts_.end())
            conflicts_.push_back(conflict);
    }
    std::vector<std::string> take() { return std::move(conflicts_); }

private:
    std::vector<std::string> conflicts_;
};

void carryMaterials(Merge& merge, const Scene& before, const SceneEdits& own, std::vector<Material>& out) {
    const auto former = counterparts(out, before.materials);
    for (size_t i = 0; i < out.size(); ++i) {
        if (!former[i]) continue;
        const Material &was = before.materials[*former[i]], &edited = own.materials[*former[i]];
        out[i].baseColor = merge.value(was.baseColor, edited.baseColor, out[i].baseColor, out[i].name);
        out[i].emission = merge.value(was.emission, edited.emission, out[i].emission, out[i].name);
    }
}

void carryPlacements(Merge& merge, const Scene& before, const SceneEdits& own, const Scene& after,
                     SceneEdits& out) {
    const auto former = counterparts(after.instances, before.instances);
    for (size_t i = 0; i < out.placements.size(); ++i) {
        if (!former[i]) continue;
        const Instance& was = before.instances[*former[i]];
        const std::string& name = after.instances[i].name;
        out.placements[i] = merge.value(Placement{was.transform, was.hidden}, own.placements[*former[i]],
                                        out.placements[i], name);
        out.densities[i] = merge.value(was.density, own.densities[*former[i]], out.densities[i], name);
    }
}

// Returns one of the file's lights as the user has it; nothing where the user took it away.
std::optional<Light> carriedLight(Merge& merge, const Light& before, const Light* own, const Light& after) {
    const bool changed = !sameLight(before, after);
    if (own == nullptr) {
        if (changed) merge.tell(after.name + ": was deleted here and edited in the file: it stays deleted");
        return std::nullopt;
    }
    if (sameLight(before, *own)) return after;
    if (changed && !sameLight(*own, after))
        merge.tell(after.name + ": was edited here and in the file: the edit stays");
    Light light = *own;
    light.node = after.node;
    return light;
}

// Returns which of the user's lights each of the file's is. One that the user renamed still has its node.
std::vector<std::optional<size_t>> editedLights(const std::vector<Light>& file,
                                                const std::vector<Light>& own) {
    auto out = counterparts(file, own);
    for (size_t i = 0; i < file.size(); ++i)
        for (size_t k = 0; !out[i] && k < own.size(); ++k)
            if (own[k].node == file[i].node && own[k].type == file[i].type &&
                std::find(out.begin(), out.end(), std::optional(k)) == out.end())
                out[i] = k;
    return out;
}

std::vector<Light> carryLights(Merge& merge, const std::vector<Light>& before, const std::vector<Light>& own,
                               const std::vector<Light>& after) {
    std::vector<Light> out;
    const auto inFile = counterparts(after, before), edited = editedLights(before, own);
    std::vector<bool> used(own.size(), false);
    std::vector<bool> stays(before.size(), false);
    for (size_t i = 0; i < after.size(); ++i) {
        if (!inFile[i]) {
            out.push_back(after[i]);
            continue;
        }
        stays[*inFile[i]] = true;
        const std::optional<size_t> mine = edited[*inFile[i]];
        if (const auto light =
                carriedLight(merge, before[*inFile[i]], mine ? &own[*mine] : nullptr, after[i]))
            out.push_back(*light);
    }
    for (size_t i = 0; i < before.size(); ++i) {
        if (!edited[i]) continue;
        used[*edited[i]] = true;
        if (!stays[i] && !before[i].preview && !sameLight(before[i], own[*edited[i]]))
            merge.tell(before[i].name + ": was edited here and deleted in the file: it is gone");
    }
    const auto wasInFile = [&](const Light& light) {
        return std::any_of(before.begin(), before.end(),
                           [&](const Light& former) { return sameLight(former, light); });
    };
    for (size_t i = 0; i < own.size(); ++i) // what the user added
        if (!used[i] && !wasInFile(own[i])) out.push_back(own[i]);
    return out;
}

bool isPreviewed(const Scene& scene) {
    return scene.sky.preview || std::any_of(scene.lights.begin(), scene.lights.end(),
                                            [](const Light& light) { return light.preview; });
}

// Tells whether a scene has light that is no preview, as isDark does it for a file without edits.
bool shines(const Scene& scene, const SceneEdits& edits) {
    const auto emits = [&](const Primitive& primitive) {
        return primitive.material >= 0 &&
               edits.materials[static_cast<size_t>(primitive.material)].emission != glm::vec3(0.0f);
    };
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
        if (!edits.placements[i].hidden && std::any_of(mesh.primitives.begin(), mesh.primitives.end(), emits))
            return true;
    }
    return !withoutPreview(edits.lights).empty() ||
           (!edits.sky.preview && edits.sky.radiance != glm::vec3(0.0f));
}

// A file that lost its last light comes with preview light. The user never saw it, and has no use for it
// where an edit that is not saved shines.
void dropNewPreview(const Scene& before, const Scene& after, SceneEdits& edits) {
    if (isPreviewed(before) || !isPreviewed(after) || !shines(after, edits)) return;
    edits.lights = withoutPreview(std::move(edits.lights));
    if (edits.sky.preview) edits.sky = {};
}

// Tells whether a file has the same lights, objects and sky as before.
bool hasSameParts(const Scene& before, const Scene& after) {
    const SceneEdits was = editsOf(before), is = editsOf(after);
    return was.placements == is.placements && was.sky == is.sky &&
           std::equal(was.lights.begin(), was.lights.end(), is.lights.begin(), is.lights.end(), sameLight);
}

} // namespace

SceneChanges changesBetween(const Scene& held, const PreparedScene& before, const PreparedScene& after) {
    const Scene &a = held, &b = after.scene;
    SceneChanges out;
    out.lights = countDifferent(withoutPreview(a.lights), withoutPreview(b.lights), sameLight);
    out.objects = countDifferent(a.instances, b.instances, [](const Instance& x, const Instance& y) {
        return x.transform == y.transform && x.hidden == y.hidden;
    });
    out.materials = countDifferent(a.materials, b.materials, [](const Material& x, const Material& y) {
        return sameColours(x, y) && sameSurface(x, y);
    });
    const bool sameNumbers = haveSameNames(before.scene.materials, b.materials);
    out.meshes = countDifferent(before.scene.meshes, b.meshes, [&](const Mesh& x, const Mesh& y) {
        return sameNumbers ? sameTriangles(x, y) : sameMesh(before.scene, x, b, y);
    });
    out.pictures = countDifferent(before.scene.images, b.images, samePixels);
    out.sky = !a.sky.preview && !b.sky.preview && static_cast<const SkySettings&>(a.sky) != b.sky;
    out.surfaces = !sameSurfaces(before, after);
    out.paint = !out.surfaces && !samePaint(before.scene, b);
    return out;
}

std::string describe(const SceneChanges& changes) {
    std::vector<std::string> parts;
    const auto add = [&](size_t count, const char* one, const char* more) {
        if (count > 0) parts.push_back(fmt::format("{} {}", count, count == 1 ? one : more));
    };
    add(changes.lights, "light", "lights");
    if (changes.sky) parts.emplace_back("the sky");
    add(changes.objects, "object", "objects");
    add(changes.materials, "material", "materials");
    add(changes.meshes, "mesh", "meshes");
    add(changes.pictures, "picture", "pictures");
    if (parts.empty()) return changes.surfaces || changes.paint ? "surfaces" : "nothing";
    return fmt::format("{}", fmt::join(parts, ", "));
}

CarriedEdits carryEdits(const Scene& before, const SceneEdits& own, const Scene& after) {
    CarriedEdits out{.edits = editsOf(after)};
    Merge merge;
    carryMaterials(merge, before, own, out.edits.materials);
    carryPlacements(merge, before, own, after, out.edits);
    out.edits.lights = carryLights(merge, before.lights, own.lights, after.lights);
    const SkySettings& wasSky = before.sky;
    out.edits.sky = merge.value(wasSky, own.sky, out.edits.sky, "the sky");
    dropNewPreview(before, after, out.edits);
    out.conflicts = merge.take();
    out.sameNumbers = haveSameNames(before.materials, after.materials) &&
                      haveSameNames(before.instances, after.instances) &&
                      haveSameNames(own.lights, out.edits.lights);
    out.sameFile = out.sameNumbers && hasSameParts(before, after);
    return out;
}

} // namespace relume
