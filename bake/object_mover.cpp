#include "bake/object_mover.h"

#include "assets/error.h"
#include "bake/texture_group.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

// Of a coordinate, what rays and boxes may round off together, with room.
constexpr float kRounding = 1e-5f;
// Where objects were, or are: each is a test per ray. An object of many parts is one.
constexpr size_t kMostBoxes = 4;
// A link that was not traced again, where none are listed.
constexpr uint32_t kKept = 0xfffffff0u;
static_assert(kKept == shader::kLinkFirstSpecial && kKept < shader::kLinkDark);

bool contains(const std::vector<uint32_t>& sorted, uint32_t value) {
    return std::binary_search(sorted.begin(), sorted.end(), value);
}

// Of triangles or patches whose instances these are, the indices of those that are among some.
std::vector<uint32_t> indicesOf(const std::vector<uint32_t>& instances, const std::vector<uint32_t>& some) {
    std::vector<uint32_t> indices;
    if (some.empty()) return indices;
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (contains(some, instances[i])) indices.push_back(i);
    return indices;
}

} // namespace

struct ObjectMover::Part {
    PatchSet patches;
    std::vector<uint32_t> slots, triangles; // where they belong among all
};

ObjectMover::ObjectMover(const On& on, bool conservative)
    : on_(on), conservative_(conservative), placed_(editsOf(on.scene).placements),
      homes_(on.patches.scene.texelToPatch) {
    for (const Placement& placement : placed_)
        known_.push_back(!placement.hidden);
}

void ObjectMover::noteInside(const std::vector<uint32_t>& links) {
    inside_.assign(on_.patches.scene.patches.size(), glm::uvec2(0));
    for (size_t i = 0; i < inside_.size(); ++i) {
        const size_t base = i / kChunk * kInsideSamples * kChunk + i % kChunk;
        for (uint32_t k = 0; k < kInsideSamples; ++k) {
            const uint32_t link = links[base + size_t{k} * kChunk];
            inside_[i].x |= uint32_t{link == shader::kLinkBack} << k;
            inside_[i].y |= uint32_t{link == shader::kLinkSky} << k;
        }
    }
}

uint32_t ObjectMover::invalidPatches() const {
    const auto& patches = on_.patches.scene.patches;
    return static_cast<uint32_t>(
        std::count_if(patches.begin(), patches.begin() + on_.patches.count, [](const shader::Patch& p) {
            return p.area > 0.0f && (p.flags & shader::kPatchSends) == 0;
        }));
}

// Nothing: some of them were hidden from the beginning.
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

// Nothing: their triangles or patches are not those that were there.
std::optional<ObjectMover::Part> ObjectMover::makePart(const Moved& moved, const LightmapAtlas& atlas) const {
    const TraceScene& all = on_.patches.scene;
    Part part;
    WorldMesh mesh = flattenInstances(on_.scene, atlas, moved.shown);
    part.triangles = indicesOf(all.mesh.instance, moved.shown);
    if (part.triangles.size() != mesh.triangleCount()) return {};
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t)
        if (all.mesh.instance[part.triangles[t]] != mesh.instance[t]) return {};
    part.slots = indicesOf(on_.patches.instance, moved.shown);
    if (mesh.triangleCount() == 0) return part;
    // Texels that charts share are whose they were.
    std::vector<uint8_t> own(homes_.size());
    uint32_t first = all.size, last = 0; // rows
    for (uint32_t texel = 0; texel < homes_.size(); ++texel) {
        const uint32_t home = homes_[texel];
        own[texel] = home != kNoPatch && contains(moved.shown, on_.patches.instance[home]);
        if (own[texel] == 0) continue;
        first = std::min(first, texel / all.size);
        last = texel / all.size + 1;
    }
    TextureGroup group = rasterizeTextureGroup(on_.device, on_.scene, mesh,
                                               {.size = all.size,
                                                .conservative = conservative_,
                                                .firstRow = first,
                                                .rows = std::max(first, last) - first});
    for (size_t texel = 0; texel < own.size(); ++texel)
        if (own[texel] == 0) group.triangle[texel] = 0;
    part.patches = buildPatches(on_.scene, std::move(mesh), group, {.part = true});
    if (part.patches.count != part.slots.size()) return {};
    for (uint32_t i = 0; i < part.patches.count; ++i) {
        const shader::Patch& patch = part.patches.scene.patches[i];
        const bool texel = part.patches.scene.texelToPatch[patch.flags >> 8] == i;
        if (texel && homes_[patch.flags >> 8] != part.slots[i]) return {};
    }
    return part;
}

// Of each instance that is there, one box; of many one around all.
std::vector<shader::TraceBox> ObjectMover::boxesOf(const Moved& moved) const {
    const WorldMesh& mesh = on_.patches.scene.mesh;
    const shader::TraceBox none{glm::vec3(1e30f), glm::vec3(-1e30f)};
    std::vector<shader::TraceBox> all(placed_.size(), none), boxes;
    for (size_t corner = 0; corner < mesh.positions.size(); ++corner) {
        shader::TraceBox& box = all[mesh.instance[corner / 3]];
        box = {glm::min(box.lo, mesh.positions[corner]), glm::max(box.hi, mesh.positions[corner])};
    }
    for (const std::vector<uint32_t>* list : {&moved.shown, &moved.gone}) {
        for (const uint32_t instance : *list) {
            const shader::TraceBox& box = all[instance];
            if (placed_[instance].hidden || box.lo.x > box.hi.x) continue;
            const glm::vec3 reach = glm::max(glm::abs(box.lo), glm::abs(box.hi));
            const float grown = kRounding * std::max({reach.x, reach.y, reach.z});
            boxes.push_back({box.lo - grown, box.hi + grown});
        }
    }
    if (boxes.size() <= kMostBoxes) return boxes;
    shader::TraceBox around = none;
    for (const shader::TraceBox& box : boxes)
        around = {glm::min(around.lo, box.lo), glm::max(around.hi, box.hi)};
    return {around};
}

// Those of what is hidden go to where other triangles are: the scene's bounds are not theirs.
void ObjectMover::putTriangles(Part& part, const Moved& moved) {
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
    if (moved.gone.empty()) return;
    glm::vec3 point(0.0f);
    for (uint32_t t = 0; t < all.mesh.triangleCount(); ++t)
        if (!on_.scene.instances[all.mesh.instance[t]].hidden) {
            point = all.mesh.positions[size_t{t} * 3];
            break;
        }
    for (const uint32_t t : indicesOf(all.mesh.instance, moved.gone))
        std::fill_n(all.mesh.positions.begin() + std::ptrdiff_t{t} * 3, 3, point);
}

// As they would be before any was found to lie inside something.
void ObjectMover::putPatches(const Part& part, const Moved& moved, ObjectMove& move) {
    PatchSet& all = on_.patches;
    const auto change = [&](uint32_t slot) {
        move.changed[slot / kChunk][static_cast<int>(slot % kChunk / 32)] |= 1u << slot % 32;
    };
    for (uint32_t i = 0; i < part.slots.size(); ++i) {
        const uint32_t slot = part.slots[i];
        const shader::Patch& patch = part.patches.scene.patches[i];
        all.scene.patches[slot] = patch;
        all.edges[slot] = part.patches.edges[i];
        repainted_ = repainted_ || all.albedoPattern[slot] != part.patches.albedoPattern[i] ||
                     all.emissionPattern[slot] != part.patches.emissionPattern[i];
        all.albedoPattern[slot] = part.patches.albedoPattern[i];
        all.emissionPattern[slot] = part.patches.emissionPattern[i];
        if (homes_[patch.flags >> 8] == slot) all.scene.texelToPatch[patch.flags >> 8] = slot;
        change(slot);
    }
    for (const uint32_t slot : indicesOf(all.instance, moved.gone)) {
        uint32_t& home = all.scene.texelToPatch[all.scene.patches[slot].flags >> 8];
        if (home == slot) home = kNoPatch;
        all.scene.patches[slot] = {};
        change(slot);
    }
}

// From the first chunk with a change to the last one.
void ObjectMover::upload(const ObjectMove& changes) const {
    uint32_t first = 0, last = on_.patches.chunkCount();
    while (first < last && !changes.changes(first))
        ++first;
    while (last > first && !changes.changes(last - 1))
        --last;
    if (first == last) return;
    const auto copy = [&](const vk::Buffer& buffer, const auto& values, size_t each) {
        const size_t size = sizeof(values[0]), from = first * each;
        vk::upload(on_.device, buffer, &values[from], (last - first) * each * size, from * size);
    };
    copy(on_.light.patches, on_.patches.scene.patches, kChunk);
    copy(on_.light.edges, on_.patches.edges, kChunk);
    copy(on_.light.bounds, on_.patches.bounds, 1);
}

// Directions that may meet what has moved are followed again.
void ObjectMover::traceInside(Tracer& tracer, const ObjectMove& move) {
    // As Baker::findInvalid does, but that few rays are traced of each batch.
    const uint32_t batch = on_.device.info().software() ? 64 : 1024;
    const uint32_t chunks = on_.patches.chunkCount(), perChunk = kInsideSamples * kChunk;
    const uint64_t words = uint64_t{std::min(batch, chunks)} * perChunk;
    const vk::Buffer links(
        on_.device,
        {.size = words * sizeof(uint32_t), .memory = vk::Memory::Host, .name = "links from inside"});
    const vk::Buffer list(on_.device, {.size = (words + 1) * sizeof(uint32_t), .name = "links to trace"});
    const vk::Buffer rays(on_.device, {.size = shader::kRayCounters * sizeof(uint32_t), .name = "rays"});
    const vk::Buffer boxes = vk::makeBuffer(on_.device, move.boxes, "boxes");
    const vk::Buffer changed = vk::makeBuffer(on_.device, move.changed, "changed patches");
    vk::Commands commands(on_.device);
    for (uint32_t first = 0; first < chunks; first += batch) {
        const uint32_t count = std::min(batch, chunks - first);
        if (tracer.onCpu()) std::fill_n(links.as<uint32_t>(), uint64_t{count} * perChunk, kKept);
        VkCommandBuffer cmd = commands.begin();
        tracer.retrace(cmd, {.closest = {.firstChunk = first,
                                         .chunkCount = count,
                                         .firstSample = 0,
                                         .sampleCount = kInsideSamples,
                                         .rotation = Rotation::Patch,
                                         .links = &links},
                             .boxes = &boxes,
                             .boxCount = static_cast<uint32_t>(move.boxes.size()),
                             .changed = &changed,
                             .list = &list,
                             .rays = &rays});
        vk::hostBarrier(cmd);
        commands.run();
        const uint32_t found =
            tracer.onCpu() ? count * perChunk : vk::readBuffer<uint32_t>(on_.device, list, 1).front();
        const auto listed =
            tracer.onCpu() ? std::vector<uint32_t>() : vk::readBuffer<uint32_t>(on_.device, list, found, 1);
        for (uint32_t i = 0; i < found; ++i) {
            const uint32_t at = tracer.onCpu() ? i : listed[i];
            const uint32_t link = links.as<uint32_t>()[at];
            if (tracer.onCpu() && link == kKept) continue;
            const uint32_t k = at / kChunk % kInsideSamples;
            glm::uvec2& bits = inside_[size_t{first + at / perChunk} * kChunk + at % kChunk];
            bits.x = (bits.x & ~(1u << k)) | uint32_t{link == shader::kLinkBack} << k;
            bits.y = (bits.y & ~(1u << k)) | uint32_t{link == shader::kLinkSky} << k;
        }
    }
}

// Patches are told from those inside something by directions of all of them, as if none were known yet.
void ObjectMover::findInside(Tracer& tracer, ObjectMove& move) {
    std::vector<shader::Patch>& patches = on_.patches.scene.patches;
    ObjectMove touched = move;
    const auto touch = [](ObjectMove& m, uint32_t i) {
        m.changed[i / kChunk][static_cast<int>(i % kChunk / 32)] |= 1u << i % 32;
    };
    std::vector<uint32_t> were; // inside something, or not there
    for (uint32_t i = 0; i < on_.patches.count; ++i) {
        if ((patches[i].flags & shader::kPatchSends) != 0) continue;
        were.push_back(i);
        if (patches[i].area <= 0.0f) continue;
        patches[i].flags |= shader::kPatchSends;
        touch(touched, i);
    }
    for (uint32_t chunk = 0; chunk < on_.patches.chunkCount(); ++chunk)
        if (move.changes(chunk)) on_.patches.bounds[chunk] = chunkBounds(on_.patches, chunk);
    upload(touched);
    tracer.update();
    traceInside(tracer, move);
    auto was = were.begin();
    for (uint32_t i = 0; i < on_.patches.count; ++i) {
        const bool before = was != were.end() && *was == i;
        was += before;
        const auto backs = static_cast<uint32_t>(std::popcount(inside_[i].x));
        const auto sky = static_cast<uint32_t>(std::popcount(inside_[i].y));
        if (liesInside(backs, sky, kInsideSamples)) patches[i].flags &= ~shader::kPatchSends;
        if (before != ((patches[i].flags & shader::kPatchSends) == 0)) {
            move.texels = true;
            touch(move, i);
        }
    }
    touched.add(move);
    upload(touched);
}

std::optional<ObjectMove> ObjectMover::follow(const LightmapAtlas& atlas, Tracer& tracer) {
    repainted_ = false;
    ObjectMove result;
    result.changed.assign(on_.patches.chunkCount(), glm::uvec2(0));
    const std::optional<Moved> instances = moved();
    if (!instances || inside_.empty() || !tracer.follows()) return {};
    if (instances->shown.empty() && instances->gone.empty()) return result;
    std::optional<Part> part = makePart(*instances, atlas);
    if (!part) return {};
    const std::vector<uint32_t> gone = instances->gone;
    ObjectMove move = result;
    move.boxes = boxesOf(*instances);
    move.instances = instances->shown;
    move.instances.insert(move.instances.end(), gone.begin(), gone.end());
    putTriangles(*part, *instances);
    putPatches(*part, *instances, move);
    const std::vector<Placement> then = std::exchange(placed_, editsOf(on_.scene).placements);
    move.texels = !gone.empty() || std::any_of(instances->shown.begin(), instances->shown.end(),
                                               [&](uint32_t i) { return then[i].hidden; });
    for (const shader::TraceBox& box : boxesOf(*instances))
        move.boxes.push_back(box);
    findInside(tracer, move);
    result.add(move);
    return result;
}

} // namespace relume
