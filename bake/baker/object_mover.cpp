#include "bake/baker/object_mover.h"

#include "assets/base/error.h"
#include "assets/base/portions.h"
#include "bake/baker/link_ends.h"
#include "bake/baker/move_boxes.h"
#include "bake/baker/move_search.h"
#include "bake/surface/patch_cover.h"
#include "bake/validity/inside_search.h"
#include "bake/validity/step_aside.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

// A bit in ObjectMover::texels_: the texel's patch is this one, not another one that shares it.
constexpr uint32_t kHome = 0x80000000u;
static_assert(kHome > kMaxSheetSize * kMaxSheetSize);

bool liesInside(const shader::Patch& patch) {
    return patch.area > 0.0f && (patch.flags & shader::kPatchSends) == 0;
}

void sortUnique(std::vector<uint32_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

std::vector<uint32_t> merged(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    std::vector<uint32_t> both;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
}

} // namespace

struct ObjectMover::Part {
    PatchSet patches;
    std::vector<uint32_t> slots, triangles;         // where they belong among all
    std::vector<uint32_t> goneSlots, goneTriangles; // of what is hidden now
};

ObjectMover::ObjectMover(const On& on, bool conservative)
    : on_(on), conservative_(conservative), placed_(editsOf(on.scene).placements),
      triangles_(on.patches.scene.mesh.instance, placed_.size()),
      slots_(on.patches.instance, placed_.size()) {
    for (const Placement& placement : placed_)
        known_.push_back(!placement.hidden);
    const std::vector<shader::Patch>& patches = on.patches.scene.patches;
    texels_.resize(patches.size());
    for (uint32_t i = 0; i < patches.size(); ++i) {
        const uint32_t texel = shader::patchTexel(patches[i].flags);
        texels_[i] = texel | (on.patches.scene.texelToPatch[texel] == i ? kHome : 0u);
    }
}

ObjectMover::~ObjectMover() = default;

void ObjectMover::noteInside(std::vector<MetBits> met, uint32_t patches) {
    inside_ = std::move(met);
    insidePatches_ = patches;
}

std::vector<uint32_t> ObjectMover::touching() const {
    return numbersWhere(on_.device.workers(), on_.patches.count,
                        [&](size_t i) { return mayTouch(inside_[i]); });
}

// Returns the objects that have moved, or nothing where some of them were hidden from the beginning.
std::optional<ObjectMover::Moved> ObjectMover::moved() const {
    Moved moved;
    for (uint32_t i = 0; i < placed_.size(); ++i) {
        const Instance& now = on_.scene.instances[i];
        const Placement& then = placed_[i];
        if (now.hidden && then.hidden) continue;
        if (now.hidden == then.hidden && now.transform == then.transform) continue;
        if (!known_[i]) return {};
        (now.hidden ? moved.gone : moved.shown).push_back(i);
    }
    return moved;
}

// Returns the tiles around the texels of these patches; one tile where there are none.
TexelWindow ObjectMover::windowOf(const std::vector<uint32_t>& slots) const {
    const uint32_t size = on_.patches.scene.size;
    glm::uvec2 first(slots.empty() ? 0 : size), last(0);
    for (const uint32_t slot : slots) {
        const uint32_t texel = texels_[slot] & ~kHome;
        const glm::uvec2 at(texel % size, texel / size);
        first = glm::min(first, at);
        last = glm::max(last, at);
    }
    first = first / kTileTexels * kTileTexels;
    last = glm::min(last / kTileTexels * kTileTexels + kTileTexels, glm::uvec2(size));
    return {first.x, first.y, last.x - first.x, last.y - first.y};
}

// Draws the moved mesh. An object that is dragged is drawn again and again: what that takes stays, but for
// large textures.
TextureGroup ObjectMover::rasterize(const WorldMesh& mesh, const TexelWindow& window) {
    constexpr uint64_t kMostKept = uint64_t{64} << 20; // [bytes]
    if (!cit_ || !cit_->serves(mesh)) {
        cit_.reset();
        cit_ = std::make_unique<CitPass>(on_.device, on_.scene, mesh);
    }
    TextureGroup group = cit_->draw(
        on_.scene, mesh, {.size = on_.patches.scene.size, .conservative = conservative_, .window = window});
    if (cit_->bytes() > kMostKept) cit_.reset();
    return group;
}

// Makes the patches of what has moved, or nothing where its triangles or patches are not those that were
// there.
std::optional<ObjectMover::Part> ObjectMover::makePart(const Moved& moved, const LightmapAtlas& atlas) {
    const TraceScene& all = on_.patches.scene;
    Part part;
    part.goneSlots = slots_.of(moved.gone);
    part.goneTriangles = triangles_.of(moved.gone);
    WorldMesh mesh = flattenInstances(on_.scene, atlas, moved.shown);
    part.triangles = triangles_.of(moved.shown);
    if (part.triangles.size() != mesh.triangleCount()) return {};
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t)
        if (all.mesh.instance[part.triangles[t]] != mesh.instance[t]) return {};
    part.slots = slots_.of(moved.shown);
    if (mesh.triangleCount() == 0) return part;
    const TexelWindow window = windowOf(part.slots);
    TextureGroup group = rasterize(mesh, window);
    const auto place = [&](uint32_t texel) { return window.index(texel % all.size, texel / all.size); };
    // Texels that charts share stay with the chart that had them.
    std::vector<uint32_t> triangle(group.triangle.size(), 0);
    for (const uint32_t slot : part.slots) {
        const size_t at = place(texels_[slot] & ~kHome);
        if ((texels_[slot] & kHome) != 0) triangle[at] = group.triangle[at];
    }
    group.triangle = std::move(triangle);
    part.patches =
        buildPatches(on_.scene, std::move(mesh), group, {.part = true, .pool = &on_.device.workers()});
    if (part.patches.count != part.slots.size()) return {};
    for (uint32_t i = 0; i < part.patches.count; ++i) {
        const uint32_t texel = shader::patchTexel(part.patches.scene.patches[i].flags);
        const bool home = part.patches.scene.texelToPatch[place(texel)] == i;
        if (texels_[part.slots[i]] != (texel | (home ? kHome : 0u))) return {};
    }
    return part;
}

// Returns one box for each instance that is there.
std::vector<shader::TraceBox> ObjectMover::boxesOf(const Moved& moved) const {
    std::vector<shader::TraceBox> boxes;
    for (const std::vector<uint32_t>* list : {&moved.shown, &moved.gone})
        for (const uint32_t instance : *list)
            if (!placed_[instance].hidden) addBox(on_.patches.scene.mesh, triangles_.of(instance), boxes);
    return fewBoxes(std::move(boxes));
}

// Puts the triangles into the scene. Those of hidden objects go to where other triangles are: the scene's
// bounds are not theirs.
void ObjectMover::putTriangles(const Part& part) {
    TraceScene& all = on_.patches.scene;
    const TraceScene& own = part.patches.scene;
    for (uint32_t t = 0; t < part.triangles.size(); ++t) {
        const size_t from = size_t{t} * 3, to = size_t{part.triangles[t]} * 3;
        std::copy_n(own.mesh.positions.begin() + static_cast<std::ptrdiff_t>(from), 3,
                    all.mesh.positions.begin() + static_cast<std::ptrdiff_t>(to));
        std::copy_n(own.mesh.normals.begin() + static_cast<std::ptrdiff_t>(from), 3,
                    all.mesh.normals.begin() + static_cast<std::ptrdiff_t>(to));
        shader::HitTriangle& hit = all.hitTriangles[part.triangles[t]];
        hit.normal = own.hitTriangles[t].normal;
        if (own.hitTriangles[t].representative != kNoPatch)
            hit.representative = part.slots[own.hitTriangles[t].representative];
    }
    putUvs(part); // they may have been repainted while they were hidden
    if (part.goneTriangles.empty()) return;
    glm::vec3 point(0.0f);
    for (uint32_t t = 0; t < all.mesh.triangleCount(); ++t)
        if (!on_.scene.instances[all.mesh.instance[t]].hidden) {
            point = all.mesh.positions[size_t{t} * 3];
            break;
        }
    for (const uint32_t t : part.goneTriangles)
        std::fill_n(all.mesh.positions.begin() + std::ptrdiff_t{t} * 3, 3, point);
}

// Puts the places in textures into the scene, which are others where materials read other textures.
void ObjectMover::putUvs(const Part& part) {
    WorldMesh& all = on_.patches.scene.mesh;
    const WorldMesh& own = part.patches.scene.mesh;
    for (uint32_t t = 0; t < part.triangles.size(); ++t) {
        const auto from = std::ptrdiff_t{3} * t, to = std::ptrdiff_t{3} * part.triangles[t];
        std::copy_n(own.baseUv.begin() + from, 3, all.baseUv.begin() + to);
        std::copy_n(own.metallicUv.begin() + from, 3, all.metallicUv.begin() + to);
    }
}

// Puts the patches into the scene as they would be before any was found to lie inside something. Returns the
// texels that have another patch.
std::vector<uint32_t> ObjectMover::putPatches(const Part& part, ObjectMove& move) {
    PatchSet& all = on_.patches;
    std::vector<uint32_t> texels;
    const auto put = [&](uint32_t slot, const shader::Patch& patch, uint32_t owner) {
        insidePatches_ -= liesInside(all.scene.patches[slot]);
        all.scene.patches[slot] = patch;
        move.change(slot);
        const uint32_t texel = texels_[slot] & ~kHome;
        if ((texels_[slot] & kHome) == 0 || all.scene.texelToPatch[texel] == owner) return;
        all.scene.texelToPatch[texel] = owner;
        texels.push_back(texel);
    };
    for (uint32_t i = 0; i < part.slots.size(); ++i) {
        const uint32_t slot = part.slots[i];
        put(slot, part.patches.scene.patches[i], slot);
        all.edges[slot] = part.patches.edges[i];
        all.covers[slot] = part.patches.covers[i];
        all.coverCells[slot] = part.patches.coverCells[i];
        repainted_ = repainted_ || all.albedoPattern[slot] != part.patches.albedoPattern[i] ||
                     all.emissionPattern[slot] != part.patches.emissionPattern[i];
        all.albedoPattern[slot] = part.patches.albedoPattern[i];
        all.emissionPattern[slot] = part.patches.emissionPattern[i];
    }
    for (const uint32_t slot : part.goneSlots) {
        put(slot, {}, kNoPatch);
        all.covers[slot] = {};
        all.coverCells[slot] = 0;
    }
    for (uint32_t chunk = 0; chunk < all.chunkCount(); ++chunk) {
        if (!move.changes(chunk)) continue;
        all.bounds[chunk] = chunkBounds(all, chunk);
        all.reach[chunk] = chunkReach(all, chunk);
    }
    std::sort(texels.begin(), texels.end());
    return texels;
}

void ObjectMover::upload(const std::vector<uint32_t>& slots, const ObjectMove& move) const {
    vk::uploadElements(on_.device, on_.light.patches, on_.patches.scene.patches, slots);
    vk::uploadElements(on_.device, on_.light.edges, on_.patches.edges, slots);
    if (on_.light.covers) vk::uploadElements(on_.device, on_.light.covers, on_.patches.covers, slots);
    std::vector<uint32_t> chunks;
    for (uint32_t chunk = 0; chunk < on_.patches.chunkCount(); ++chunk)
        if (move.changes(chunk)) chunks.push_back(chunk);
    vk::uploadElements(on_.device, on_.light.bounds, on_.patches.bounds, chunks);
}

// Follows directions again that may meet what has moved. Returns the patches whose directions meet something
// else now.
std::vector<uint32_t> ObjectMover::traceInside(Tracer& tracer, const ObjectMove& move) {
    std::vector<uint32_t> others;
    searchFor(tracer).retrace(move, [&](uint32_t patch, uint32_t direction, uint32_t link) {
        const MetBits before = inside_[patch];
        inside_[patch].note(direction, link);
        if (inside_[patch] != before) others.push_back(patch);
    });
    sortUnique(others);
    return others;
}

// Tells again which of these patches lie inside something. Returns those that were not and are, or the other
// way round.
std::vector<uint32_t> ObjectMover::findInside(Tracer& tracer, const std::vector<uint32_t>& patches,
                                              ObjectMove& move) {
    // The first directions told enough of these before.
    std::vector<uint32_t> unknown;
    for (const uint32_t i : patches)
        if (on_.patches.scene.patches[i].area > 0.0f && insideBy(inside_[i]) == Inside::Unknown)
            unknown.push_back(i);
    followAll(on_.device, tracer, on_.patches, unknown, inside_);
    std::vector<uint32_t> others;
    for (const uint32_t i : patches) {
        shader::Patch& patch = on_.patches.scene.patches[i];
        if (patch.area <= 0.0f) continue;
        const bool before = liesInside(patch), now = insideBy(inside_[i]) == Inside::Yes;
        if (before == now) continue;
        patch.flags ^= shader::kPatchSends;
        now ? ++insidePatches_ : --insidePatches_;
        move.texels = true;
        move.change(i);
        others.push_back(i);
    }
    return others;
}

CoverSearch ObjectMover::coverSearch(Tracer& tracer) const {
    return {.device = on_.device,
            .tracer = tracer,
            .patches = on_.patches,
            .devicePatches = &on_.light.patches,
            .deviceCovers = &on_.light.covers};
}

MoveSearch& ObjectMover::searchFor(Tracer& tracer) {
    if (!search_ || &search_->tracer() != &tracer)
        search_ = std::make_unique<MoveSearch>(coverSearch(tracer));
    return *search_;
}

// Tells whether what has moved stands in the patch's texel, or stood there.
bool ObjectMover::isNear(uint32_t patch, const ObjectMove& move) const {
    const shader::Patch& p = on_.patches.scene.patches[patch];
    const shader::PatchCover& cover = on_.patches.covers[patch];
    const glm::vec3 reach = glm::abs(cover.du) + glm::abs(cover.dv) + 2.0f * p.offset;
    return std::any_of(move.boxes.begin(), move.boxes.end(), [&](const shader::TraceBox& box) {
        return glm::all(glm::lessThanEqual(p.position - reach, box.hi)) &&
               glm::all(glm::greaterThanEqual(p.position + reach, box.lo));
    });
}

// Finds again where samples may start in texels that what has moved stands in, or stood in.
void ObjectMover::findCovers(CoverSearcher& covers, const std::vector<uint32_t>& slots, ObjectMove& move) {
    PatchSet& patches = on_.patches;
    if (!on_.light.covers) return;
    const std::vector<uint32_t> which =
        numbersWhere(on_.device.workers(), patches.coverCells.size(), [&](size_t i) {
            const auto patch = static_cast<uint32_t>(i);
            return patches.coverCells[i] != 0 && (move.has(patch) || isNear(patch, move));
        });
    const std::vector<uint32_t> others = covers.search(which);
    for (const uint32_t i : others)
        move.change(i);
    vk::uploadElements(on_.device, on_.light.covers, patches.covers, merged(slots, others));
}

ObjectMove ObjectMover::takeOver(const FormerSurfaces& former, const PatchCarry& carry, Tracer& tracer) {
    const PatchSet& patches = on_.patches;
    ObjectMove move;
    move.changed.assign(patches.chunkCount(), glm::uvec2(0));
    move.instances = carry.changed;
    inside_.assign(patches.scene.patches.size(), MetBits{});
    std::vector<uint32_t> slots;
    for (uint32_t i = 0; i < patches.count; ++i) {
        if (carry.former[i] != kNoPatch) {
            inside_[i] = former.inside[carry.former[i]];
            insidePatches_ += liesInside(patches.scene.patches[i]);
            continue;
        }
        move.change(i);
        slots.push_back(i);
    }
    std::vector<shader::TraceBox> boxes;
    for (const uint32_t instance : carry.changed)
        addBox(patches.scene.mesh, triangles_.of(instance), boxes);
    move.boxes = fewBoxes(std::exchange(boxes, {}));
    const ObjectMembers gone(former.patches.scene.mesh.instance, former.instances);
    for (const uint32_t instance : carry.gone)
        addBox(former.patches.scene.mesh, gone.of(instance), boxes);
    boxes = fewBoxes(std::move(boxes));
    move.boxes.insert(move.boxes.end(), boxes.begin(), boxes.end());
    const std::vector<OwnPoint> aside = carryAside(former.aside, carry.now);
    if (move.boxes.empty())
        stepAside(tracer, aside, move);
    else
        move = searched(tracer, slots, aside, move);
    // The tracer is new and took all of them to be silent, those as well that step where they stepped before.
    std::vector<uint32_t> senders;
    for (const OwnPoint& home : patches.aside)
        senders.push_back(home.patch);
    tracer.updateSenders(senders);
    return move;
}

// Lets patches step aside anew: what they meet there may come from far away. Returns those that did before or
// do now, but not both.
std::vector<uint32_t> ObjectMover::stepAside(Tracer& tracer, const std::vector<OwnPoint>& before,
                                             ObjectMove& move) {
    if (!on_.light.covers) return {};
    std::vector<OwnPoint> known;
    for (const OwnPoint& point : before)
        if (!move.has(point.patch) && !isNear(point.patch, move)) known.push_back(point);
    MoveSearch& search = searchFor(tracer);
    relume::stepAside(search.covers(), oneProcess(), ChunkDeal(on_.patches.chunkCount(), 1, {}), touching(),
                      known, &search.places());
    OtherPoints others = otherPoints(before, pointsAside(on_.patches));
    for (const uint32_t patch : others.points)
        move.change(patch);
    move.texels = move.texels || !others.senders.empty();
    return std::move(others.senders);
}

// Looks anew which patches lie inside something and where samples start, near a move of these patches, all of
// which have stepped back from where they were before.
ObjectMove ObjectMover::searched(Tracer& tracer, const std::vector<uint32_t>& slots,
                                 const std::vector<OwnPoint>& before, ObjectMove& move) {
    const std::vector<uint32_t> others = findInside(tracer, merged(slots, traceInside(tracer, move)), move);
    vk::uploadElements(on_.device, on_.light.patches, on_.patches.scene.patches, others);
    findCovers(searchFor(tracer).covers(), slots, move);
    const std::vector<uint32_t> senders = merged(others, stepAside(tracer, before, move));
    tracer.updateSenders(merged(slots, senders));
    addLinkEnds(on_.patches.scene, senders, move);
    ObjectMove result;
    result.add(move); // many boxes become one
    return result;
}

bool ObjectMover::repaint(const LightmapAtlas& atlas, std::span<const uint32_t> instances) {
    cit_.reset(); // it has the textures that were
    Moved painted;
    for (const uint32_t instance : instances)
        if (!placed_[instance].hidden) painted.shown.push_back(instance);
    const std::optional<Part> part = makePart(painted, atlas);
    if (!part) return false;
    putUvs(*part);
    for (uint32_t i = 0; i < part->slots.size(); ++i)
        on_.patches.albedoPattern[part->slots[i]] = part->patches.albedoPattern[i];
    return true;
}

std::optional<ObjectMove> ObjectMover::follow(const LightmapAtlas& atlas, Tracer& tracer) {
    repainted_ = false;
    ObjectMove move;
    move.changed.assign(on_.patches.chunkCount(), glm::uvec2(0));
    const std::optional<Moved> instances = moved();
    if (!instances || inside_.empty() || !tracer.follows()) return {};
    if (instances->shown.empty() && instances->gone.empty()) return move;
    const std::optional<Part> part = makePart(*instances, atlas);
    if (!part) return {};
    move.boxes = boxesOf(*instances);
    for (const std::vector<uint32_t>* list : {&instances->shown, &instances->gone})
        move.instances.insert(move.instances.end(), list->begin(), list->end());
    const std::vector<OwnPoint> aside = stepBack(coverSearch(tracer));
    putTriangles(*part);
    const std::vector<uint32_t> texels = putPatches(*part, move);
    move.texels = !texels.empty();
    for (const uint32_t i : move.instances)
        placed_[i] = {on_.scene.instances[i].transform, on_.scene.instances[i].hidden};
    for (const shader::TraceBox& box : boxesOf(*instances))
        move.boxes.push_back(box);
    const std::vector<uint32_t> slots = merged(part->slots, part->goneSlots);
    upload(slots, move);
    tracer.update({.triangles = merged(part->triangles, part->goneTriangles), .texels = texels});
    return searched(tracer, slots, aside, move);
}

} // namespace relume
