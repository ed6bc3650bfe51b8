#include "bake/baker/baker.h"

#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/watch.h"
#include "bake/baker/memory_plan.h"
#include "bake/baker/object_mover.h"
#include "bake/layers/layer_solver.h"
#include "bake/output/layer_sum.h"
#include "bake/surface/cit_pass.h"
#include "bake/surface/known_covers.h"
#include "bake/surface/repaint.h"
#include "bake/surface/texture_group.h"
#include "bake/validity/cover_search.h"
#include "bake/validity/inside_search.h"
#include "bake/validity/step_aside.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <tuple>

namespace relume {
namespace {

// The light of more patches is nothing that one sees at a glance.
constexpr uint32_t kMostOfGlance = 1u << 21;

// Returns which chunks' validity each rank finds.
ChunkDeal dealOf(const PatchSet& patches, Ranks& ranks, const vk::Device& device) {
    return {patches.chunkCount(), ranks.count(), ChunkDeal::runsFor(device.info().software())};
}

TracerKind tracerKind(const BakeSettings& settings, const vk::DeviceInfo& device, std::string& why) {
    const TracerKind kind = settings.voxels.ratio == 1 ? TracerKind::Voxel : settings.tracer;
    return kind == TracerKind::Auto ? chooseTracer(device, why) : kind;
}

// Returns the kind that traces triangles, Auto where none does.
TracerKind exactTracer(const BakeSettings& settings, const vk::DeviceInfo& device) {
    std::string why;
    if (usesVoxels(settings) && settings.solver.transport.rtrad) return TracerKind::Auto;
    const TracerKind kind = tracerKind(settings, device, why);
    return kind == TracerKind::Voxel ? chooseTracer(device, why) : kind;
}

// The parts of a scene that its materials are painted with.
using Pictures = std::pair<std::vector<Image>, std::vector<Texture>>;
Pictures takePictures(Scene& scene) {
    return {std::exchange(scene.images, {}), std::exchange(scene.textures, {})};
}

} // namespace

Baker::Baker(const vk::Device& device, const Scene& scene, BakeSurfaces surfaces,
             const BakeSettings& settings, PhaseHook phaseHook)
    : Baker(device, scene, nullptr, std::move(surfaces), settings, std::move(phaseHook), Preparation::Whole) {
}

Baker::Baker(const vk::Device& device, Scene& scene, BakeSurfaces surfaces, const BakeSettings& settings,
             PhaseHook phaseHook, Preparation preparation)
    : Baker(device, scene, &scene, std::move(surfaces), settings, std::move(phaseHook), preparation) {}

Baker::Baker(const vk::Device& device, const Scene& scene, Scene* editable, BakeSurfaces surfaces,
             const BakeSettings& settings, PhaseHook phaseHook, Preparation preparation)
    : device_(device), scene_(scene), editable_(editable), settings_(settings),
      phaseHook_(std::move(phaseHook)) {
    requireRoom(surfaces);
    std::optional<TreeAhead> tree;
    if (exactTracer(settings_, device.info()) == TracerKind::Bvh)
        tree.emplace(surfaces.mesh, device.workers());
    PhaseClock clock(phases_);
    makePatches(std::move(surfaces.mesh), surfaces.former, clock);
    std::optional<Carry> carry = carryFrom(surfaces.former);
    planSpill();
    {
        const vk::MemoryOwner owner("surface");
        light_ = std::make_unique<LightBuffers>(device, patches_, settings_.solver.spill);
    }
    colours_ = std::make_unique<SurfaceColours>(scene.materials);
    clock.end("patches");

    if (followsObjects(settings_))
        mover_ = std::make_unique<ObjectMover>(ObjectMover::On{device, scene, patches_, *light_},
                                               settings.conservative);
    makeTracers(tree ? &*tree : nullptr);
    whole_ = preparation == Preparation::Whole || !followsObjects(settings_) || carry ||
             patches_.count > kMostOfGlance || !makeGlance();
    if (!whole_) return;
    findValidity(carry ? &*carry : nullptr);
    if (usesVoxels(settings_)) makeVoxels();
    onPhase("solver set-up");
    PhaseClock setUp(phases_);
    std::optional<LayerCarry> layers;
    if (carry) layers.emplace(layerCarry(*carry));
    solver_ = makeSolver(solverInput(), settings_.solver, layers ? &*layers : nullptr);
    setUp.end("solver set-up");
}

// Makes a solver for a first glance; returns false where there is no memory for its layers.
bool Baker::makeGlance() {
    SolverSettings glance = settings_.solver;
    glance.layers.optional = false;
    glance.links.allOver = false; // covers are not known yet
    glance.links.samples = LayerSolver::kPointsOfSamplePass;
    try {
        solver_ = makeSolver(solverInput(), glance);
    } catch (const Error&) {
        return false;
    }
    return true;
}

// Throws Error where the size does not fit. What a former bake has left is given up before.
void Baker::requireRoom(BakeSurfaces& surfaces) const {
    const LightmapPages& pages = surfaces.mesh.pages;
    if (pages.count > 1 && settings_.size % kPageStep != 0)
        throw Error("--size " + std::to_string(settings_.size) + ": the lightmap has " +
                    std::to_string(pages.count) + " pages, whose size is a multiple of " +
                    std::to_string(kPageStep) + ": give --size " +
                    std::to_string((settings_.size + kPageStep - 1) / kPageStep * kPageStep));
    const SceneExtent extent = extentOf(scene_, surfaces.mesh);
    const auto problem = [&] { return planMemory(settings_, extent, roomOn(device_)).problem; };
    std::string now = problem();
    if (!now.empty() && surfaces.former) {
        std::exchange(surfaces.former, nullptr)->layers = {};
        now = problem();
    }
    if (!now.empty()) throw Error(now);
}

// Decides what the host's memory holds, now that it is known how many patches there are.
void Baker::planSpill() {
    settings_.solver.spill =
        spillOf(settings_, extentOf(scene_, patches_.scene.mesh),
                extentOf(patches_, scene_.sky, device_.info().software()), device_.freeMemory());
    if (settings_.solver.spill == Spill::None) return;
    spdlog::info("memory: '{}' has no room for all, {} MiB are read from this machine's memory",
                 device_.info().name, spilledBytes() >> 20);
}

uint64_t Baker::spilledBytes() const {
    return memoryNeeds(settings_, extentOf(scene_, patches_.scene.mesh),
                       extentOf(patches_, scene_.sky, device_.info().software()))
        .spilled;
}

void Baker::makePatches(WorldMesh mesh, const FormerBake* former, PhaseClock& clock) {
    const TransportSettings& transport = settings_.solver.transport;
    onPhase("cit");
    const vk::MemoryOwner owner("cit");
    const TextureGroup group = rasterizeTextureGroup(device_, scene_, mesh,
                                                     {.size = mesh.pages.sheetOf(settings_.size),
                                                      .conservative = settings_.conservative,
                                                      .rtrad = transport.rtrad});
    clock.end("cit");
    onPhase("patches");
    const PatchDesc desc{
        .reflectivity = transport.reflectivity, .rtrad = transport.rtrad, .pool = &device_.workers()};
    if (goesOnWith(former, mesh.pages)) {
        const KnownCovers known =
            knownCovers({former->scene, former->patches}, mesh, scene_.instances.size());
        patches_ = buildPatches(scene_, std::move(mesh), group, desc, known);
    } else {
        patches_ = buildPatches(scene_, std::move(mesh), group, desc);
    }
    if (patches_.clampedAlbedo == 0) return;
    spdlog::warn("{} patches have an albedo above 0.98 (reflectivity counted in), which is clamped: "
                 "lower the base colour",
                 patches_.clampedAlbedo);
}

// Tells whether there is something to go on with. Directions that a chunk shares would be others where its
// patches are.
bool Baker::goesOnWith(const FormerBake* former, const LightmapPages& pages) const {
    return former != nullptr && followsObjects(settings_) && former->patches.scene.mesh.pages == pages &&
           former->patches.scene.pageSize() == settings_.size &&
           settings_.solver.links.rotation != Rotation::Tile;
}

// Finds what stays of a former bake.
std::optional<Baker::Carry> Baker::carryFrom(FormerBake* former) {
    if (!goesOnWith(former, patches_.scene.mesh.pages)) return std::nullopt;
    Carry carry{.former = *former,
                .patches = carryPatches({former->scene, former->patches}, {scene_, patches_})};
    carrySearches(carry.patches, former->patches, patches_);
    return carry;
}

LayerCarry Baker::layerCarry(const Carry& carry) const {
    const Sky &was = carry.former.scene.sky, &is = scene_.sky;
    return {.former = carry.former.layers,
            .patches = carry.patches,
            .move = carry.move,
            .formerTexels = carry.former.patches.scene.texelToPatch,
            .sameSky = was.file == is.file && was.pixels == is.pixels,
            .sameColours = carry.patches.same && sameColours(carry.former.patches, patches_)};
}

Baker::~Baker() = default;

std::optional<FormerBake> Baker::release() {
    if (!whole_ || !mover_ || !solver_.layers) return std::nullopt;
    FormerBake former;
    former.layers = solver_.layers->release();
    former.inside = mover_->giveInside();
    solver_ = {};
    mover_.reset();
    tracer_.reset(); // it borrows the patches
    former.aside = relume::stepBack(patches_);
    former.patches = std::move(patches_);
    return former;
}

void Baker::complete() {
    ASSERT(!whole_);
    findValidity(nullptr);
    whole_ = true;
}

// Makes the tracer of triangles, which also tell whether a patch lies inside something: a voxel knows no
// inside.
void Baker::makeTracers(TreeAhead* tree) {
    const vk::MemoryOwner owner("trace");
    std::string why = "as asked for";
    const TracerKind kind = tracerKind(settings_, device_.info(), why);
    const bool marches = usesVoxels(settings_);
    tracerChoice_ = fmt::format("{} ({})", tracerName(kind), why);
    spdlog::info("tracer: {}", tracerChoice_);
    if (marches) {
        spdlog::info("voxels: {} through {}^3 of them",
                     settings_.voxels.ratio > 1 ? fmt::format("1 sender in {}", settings_.voxels.ratio)
                                                : "all senders",
                     settings_.voxels.resolution);
    }
    if (marches && settings_.solver.transport.rtrad) return;
    PhaseClock clock(phases_);
    onPhase("tracer");
    tracer_ = makeTracer(exactTracer(settings_, device_.info()), device_, patches_.scene, light_->patches, {},
                         tree);
    clock.end("tracer");
}

void Baker::findValidity(Carry* carry) {
    const vk::MemoryOwner owner("trace");
    PhaseClock clock(phases_);
    if (!settings_.solver.transport.rtrad) findInvalid(carry);
    makeCovers();
    clock.end("validity");
    if (inside_ > 0)
        spdlog::info(
            "{} of {} patches lie inside something: {} of them step aside in their texels, the others "
            "send nothing and are filled from their neighbours",
            inside_, patches_.count, asideFromInside(patches_));
}

uint32_t Baker::invalidPatches() const {
    return inside_ - asideFromInside(patches_);
}

void Baker::makeVoxels() {
    const vk::MemoryOwner owner("trace");
    PhaseClock clock(phases_);
    onPhase("voxels");
    tracer_.reset();
    std::string why;
    tracer_ = makeTracer(tracerKind(settings_, device_.info(), why), device_, patches_.scene, light_->patches,
                         settings_.voxels);
    clock.end("voxels");
}

// Finds where samples may start that start all over their texels, once, and lets patches step aside. Other
// methods know no parts of texels: for them patches step back, and covers would be found again.
void Baker::makeCovers() {
    const bool wanted = startsAllOver(settings_.solver) && !patches_.covers.empty();
    if (wanted == static_cast<bool>(light_->covers)) return;
    vk::Buffer covers = wanted ? makeDeviceCovers() : std::move(light_->covers);
    CoverSearcher searcher({.device = device_,
                            .tracer = *tracer_,
                            .patches = patches_,
                            .devicePatches = &light_->patches,
                            .deviceCovers = &covers,
                            .onBatch = [this](double) { onPhase("validity", 1.0); }});
    if (!wanted) {
        std::vector<uint32_t> back;
        for (const OwnPoint& point : stepBack(searcher.on()))
            back.push_back(point.patch);
        return tracer_->updateSenders(back);
    }
    const ChunkDeal dealt = dealOf(patches_, ranks(), device_);
    const std::vector<uint32_t> covered = coveredPatches(patches_, device_.workers());
    searcher.search(patchesIn(dealt.runsOf(ranks().rank()), covered));
    shareCells(ranks(), dealt, covered, patches_, device_.workers());
    vk::upload(device_, covers, patches_.covers.data(), patches_.covers.size() * sizeof(shader::PatchCover));
    searcher.release(); // memory is planned for one search at a time
    tracer_->updateSenders(stepAside(searcher, ranks(), dealt, mover_ ? mover_->touching() : touching_));
    light_->covers = std::move(covers);
}

vk::Buffer Baker::makeDeviceCovers() const {
    const vk::MemoryOwner owner("surface");
    return vk::makeBuffer(device_, patches_.covers, "covers");
}

// Finds the patches inside something, once, before the first pass.
void Baker::findInvalid(Carry* carry) {
    if (carry) {
        if (startsAllOver(settings_.solver) && !patches_.covers.empty()) light_->covers = makeDeviceCovers();
        onPhase("validity");
        const FormerBake& former = carry->former;
        carry->move =
            mover_->takeOver({former.patches, former.scene.instances.size(), former.inside, former.aside},
                             carry->patches, *tracer_);
        inside_ = mover_->insidePatches();
    } else {
        searchInside();
    }
}

void Baker::searchInside() {
    std::vector<MetBits> met;
    InsideSearch search{.device = device_,
                        .tracer = *tracer_,
                        .patches = patches_,
                        .chunks = {},
                        .met = mover_ ? &met : nullptr,
                        .touching = &touching_,
                        .onBatch = [this](double done) { onPhase("validity", done); }};
    const ChunkDeal dealt = dealOf(patches_, ranks(), device_);
    const std::span<const ChunkRange> own = dealt.runsOf(ranks().rank());
    search.chunks.assign(own.begin(), own.end());
    std::vector<uint32_t> inside = findInside(search);
    if (!ranks().alone()) { // each knows its own
        std::vector<uint8_t> marks(patches_.scene.patches.size(), 0);
        for (const uint32_t patch : inside)
            marks[patch] = 1;
        shareChunks(ranks(), dealt, marks);
        inside.clear();
        for (uint32_t patch = 0; patch < marks.size(); ++patch)
            if (marks[patch] != 0) inside.push_back(patch);
    }
    inside_ = static_cast<uint32_t>(inside.size());
    if (mover_) mover_->noteInside(std::move(met), inside_);
    if (inside_ == 0) return;
    for (const uint32_t patch : inside)
        patches_.scene.patches[patch].flags &= ~shader::kPatchSends;
    vk::upload(device_, light_->patches, patches_.scene.patches.data(),
               patches_.scene.patches.size() * sizeof(shader::Patch));
    tracer_->updateSenders(inside);
}

void Baker::onPhase(const char* phase, double done) const {
    tellWatch(phase, done);
    if (phaseHook_) phaseHook_(phase);
}

void Baker::resetSolver(const SolverSettings& settings) {
    solver_ = {}; // before the new one takes its memory
    const Spill spill = settings_.solver.spill;
    settings_.solver = settings;
    settings_.solver.spill = std::min(spill, mostSpill(settings));
    makeCovers();
    solver_ = makeSolver(solverInput(), settings_.solver);
}

void Baker::restart(const SceneEdits& wanted, const SolverSettings& settings) {
    ASSERT(editable_ && wanted.sky.file == scene_.sky.file);
    ASSERT(!differenceBetween(scene_, wanted).objects);
    applyEdits(*editable_, wanted);
    updateMaterials();
    resetSolver(settings);
}

Applied Baker::apply(const BakeEdits& edits) {
    SceneDifference difference = differenceBetween(scene_, edits.scene);
    difference.colours = difference.colours || edits.repainted;
    LayerSolver* const layers = solver_.layers;
    const Applied applied =
        decideEdit(difference, {.follows = editable_ && layers,
                                .fits = layers && layers->holds(edits.scene.lights.size()),
                                .atRest = layers && layers->atRest()});
    if (applied != Applied::Now) return applied;
    const bool mayFail = difference.objects || edits.repainted;
    const SceneEdits before = mayFail ? editsOf(scene_) : SceneEdits();
    std::vector<uint8_t> painted;
    Pictures pictures;
    if (edits.repainted) {
        painted = repaintedMaterials(scene_, *edits.repainted, edits.scene.materials);
        pictures = takePictures(*editable_);
        editable_->images = edits.repainted->images;
        editable_->textures = edits.repainted->textures;
    }
    applyEdits(*editable_, edits.scene);
    const auto takeBack = [&] {
        applyEdits(*editable_, before);
        if (edits.repainted) std::tie(editable_->images, editable_->textures) = std::move(pictures);
        return Applied::NeedsNewBake;
    };
    if (edits.repainted && !repaint(edits, painted)) return takeBack();
    std::optional<ObjectMove> move;
    if (difference.objects) {
        move = moveObjects(edits.atlas);
        if (!move) return takeBack();
    }
    if (difference.colours) updateMaterials();
    if (move) layers->moveObjects(*move);
    layers->edit(edits.mix, edits.repainted != nullptr);
    return Applied::Now;
}

// Gives patches of these materials the patterns that these make now. Returns false where that cannot be done.
bool Baker::repaint(const BakeEdits& edits, const std::vector<uint8_t>& materials) {
    if (!mover_ || edits.atlas == nullptr) return false;
    std::vector<uint8_t> painted(scene_.instances.size(), 0);
    for (uint32_t triangle = 0; triangle < patches_.scene.mesh.triangleCount(); ++triangle) {
        const uint32_t material = patches_.scene.mesh.material[triangle];
        if (material < materials.size() && materials[material] != 0)
            painted[patches_.scene.mesh.instance[triangle]] = 1;
    }
    std::vector<uint32_t> instances;
    for (uint32_t i = 0; i < painted.size(); ++i)
        if (painted[i] != 0) instances.push_back(i);
    if (!mover_->repaint(*edits.atlas, instances)) return false;
    colours_->updateAll(device_, scene_.materials, patches_, *light_);
    return true;
}

void Baker::updateMaterials() {
    colours_->update(device_, scene_.materials, patches_, *light_);
}

// Moves, hides and shows objects as the scene has them now. Returns nothing where that cannot be followed;
// then all is as it was.
std::optional<ObjectMove> Baker::moveObjects(const LightmapAtlas* atlas) {
    if (!mover_ || atlas == nullptr) return {};
    const Clock::time_point start = Clock::now();
    std::optional<ObjectMove> move = mover_->follow(*atlas, *tracer_);
    if (move) {
        inside_ = mover_->insidePatches();
        if (mover_->repainted()) colours_->updateAll(device_, scene_.materials, patches_, *light_);
        if (move->texels) ++moves_.texels;
    }
    moves_.seconds += secondsSince(start);
    return move;
}

FloatImage Baker::lightmap(LightmapDesc desc) const {
    desc.rtrad = settings_.solver.transport.rtrad;
    desc.reflectivity = settings_.solver.transport.reflectivity;
    desc.pool = &workers();
    FloatImage lightmap = makeLightmap(patches_, solver_.solver->light(), desc);
    if (!sumsLayers(desc)) return lightmap;
    LayerSum sum(workers(), lightmap.width, lightmap.height);
    for (const std::unique_ptr<Layer>& layer : solver_.layers->layers())
        if (layer->shines() && layer->shown())
            sum.add(layer->source.weight,
                    makeLightmap(patches_, solver_.layers->layerLight(*layer->shown()), desc));
    sum.writeTo(lightmap);
    requireFiniteTexels(lightmap);
    return lightmap;
}

bool Baker::sumsLayers(const LightmapDesc& desc) const {
    return solver_.layers && solver_.solver->done() && desc.quantity == Quantity::Lighting;
}

FloatImage Baker::errorMap() const {
    const std::vector<float> errors = solver_.solver->errors();
    if (errors.empty())
        throw Error("--error-map: one pass says nothing about its error: let the bake run for two or more");
    std::vector<glm::vec4> grey;
    for (float e : errors)
        grey.emplace_back(e, e, e, 1.0f);
    return makeLightmap(patches_, grey, {.sew = false, .pool = &workers()});
}

} // namespace relume
