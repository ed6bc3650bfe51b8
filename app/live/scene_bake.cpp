#include "app/live/scene_bake.h"

#include "app/live/layer_remark.h"
#include "app/offline/solve.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/sky_picture.h"

#include <utility>

namespace relume {

std::string SceneBake::remark() const {
    return layers() ? "" : layerRemark(wantsLayers_, settings().solver, *baker_, scene_);
}

Applied SceneBake::edit(const Start& start) {
    const BakeRecipe wanted{.surfaces = start.surfaces, .settings = start.settings, .rings = start.rings};
    if (due_ || !layers() || !differOnlyInEdits(recipe_, wanted)) return Applied::NeedsNewBake;
    const Applied applied =
        baker_->apply({.scene = start.edits,
                       .mix = start.mix,
                       .atlas = &start.scene->atlas,
                       .repainted = start.paint != paint_ ? &start.scene->scene : nullptr});
    if (applied != Applied::Now) return applied;
    paint_ = start.paint;
    mix_ = start.mix;
    return applied;
}

bool SceneBake::keepsPatches(const Start& start) const {
    return baker_ && start.surfaces == recipe_.surfaces && start.paint == paint_ &&
           !differenceBetween(scene_, start.edits).any() && samePatches(start.settings, settings());
}

void SceneBake::takeUp(const Start& start, double batchMs) {
    const BakeRecipe wanted{.surfaces = recipe_.surfaces, .settings = start.settings, .rings = recipe_.rings};
    goesOn_ = (former_ || layers()) && start.keepLight && start.settings.solver.layers.on &&
              differOnlyInEdits(recipe_, wanted);
    if (!goesOn_) former_.reset();
    due_ = true;
    recipe_.settings = bakeable(start.settings, batchMs);
    recipe_.rings = start.rings;
    wantsLayers_ = start.settings.solver.layers.on;
    mix_ = start.mix;
}

void SceneBake::make(const vk::Device& device, const Start& start) {
    if (goesOn_) keepFormer(device);
    baker_.reset(); // before the new one takes its memory
    scene_ = start.scene->scene;
    const bool moved = differenceBetween(scene_, start.edits).objects;
    applyEdits(scene_, start.edits);
    readEditedPicture(scene_.sky);
    atlas_ = start.scene->atlas;
    recipe_.surfaces = start.surfaces;
    paint_ = start.paint;
    // A GPU finds in no time what a glance would do without. Light that is shown is better than a glance.
    const bool glance = device.info().software() && !start.keepLight;
    makeBaker(device, moved ? flatten(scene_, start.scene->atlas) : start.scene->mesh,
              glance ? Preparation::FirstGlance : Preparation::Whole);
}

void SceneBake::complete() {
    baker_->complete();
    tellPatches();
}

// Keeps what the next bake of the level goes on with, as far as that takes no more than a share of the memory
// that is free without the rest: the new one has as much memory of its own. A bake that was given up on its
// way has left nothing, so that what the one before it left still counts.
void SceneBake::keepFormer(const vk::Device& device) {
    constexpr uint64_t kShare = 4;
    if (!baker_) return;
    former_ = baker_->release();
    baker_.reset();
    if (!former_) return;
    former_->scene = std::move(scene_);
    former_->layers.keepWithin(device.freeMemory() / kShare);
}

void SceneBake::makeAgain(const vk::Device& device) {
    WorldMesh mesh = baker_->patches().scene.mesh;
    baker_.reset();
    former_.reset();
    makeBaker(device, std::move(mesh), Preparation::Whole);
}

void SceneBake::makeBaker(const vk::Device& device, WorldMesh mesh, Preparation preparation) {
    FormerBake* const former = former_ ? &*former_ : nullptr;
    baker_ = std::make_unique<Baker>(device, scene_, BakeSurfaces(std::move(mesh), former), settings(),
                                     Baker::PhaseHook(), preparation);
    former_.reset();
    weighLights();
    if (isGlance()) return;
    due_ = false;
    tellPatches();
}

void SceneBake::tellPatches() const {
    spdlog::info("{} patches", baker_->patches().count);
    warnIfDark(scene_, baker_->patches());
}

void SceneBake::makeSolver() {
    baker_->resetSolver(settings().solver);
    weighLights();
    due_ = false;
}

// A solver that was just made knows nothing of mutes and solos.
void SceneBake::weighLights() {
    if (!layers()) return;
    const Applied applied = baker_->apply({.scene = editsOf(scene_), .mix = mix_});
    ASSERT(applied == Applied::Now);
}

void SceneBake::end() {
    baker_.reset();
    former_.reset();
    recipe_.surfaces = 0;
}

} // namespace relume
