#pragma once

#include <memory>
#include <optional>

#include "app/export/surface_light.h"
#include "app/live/bake_desk.h"
#include "app/live/bake_recipe.h"

namespace relume {

/// The bake that a viewer shows: of one scene with its edits. An edit is followed with what there is as far
/// as that goes. Only the bake thread uses it.
class SceneBake {
public:
    using Start = BakeOrders::Start;

    /// Returns nullptr until a bake was made, and after one was given up.
    Baker* baker() const { return baker_.get(); }
    /// Returns its layers, or nullptr.
    const LayerSolver* layers() const { return baker_ ? baker_->layers() : nullptr; }
    /// Returns the scene with the edits that the bake follows; there is a baker.
    AtlasLevel level() const { return {scene_, atlas_, baker_->patches().scene.mesh}; }
    /// Tells whether these surfaces are baked.
    bool isOf(uint64_t surfaces) const { return recipe_.surfaces == surfaces; }
    const BakeSettings& settings() const { return recipe_.settings; }
    uint32_t rings() const { return recipe_.rings; }
    /// Tells why there are no layers though they were asked for, with the remedy; "" where nothing is
    /// missing.
    std::string remark() const;

    /// Edits the bake where the start asks for no more than that.
    Applied edit(const Start& start);
    /// Tells whether the start is of the same scene with the same edits, and wants the same patches.
    bool keepsPatches(const Start& start) const;

    /// Takes up what the start wants beside its scene. A baker or a solver is to be made next; until then the
    /// former one follows no edit.
    void takeUp(const Start& start, double batchMs);
    /// Tells whether the bake that is made next goes on with what the one before has, as the start that was
    /// taken up differs in its surfaces alone.
    bool goesOn() const { return goesOn_; }
    /// Makes the bake. Throws Error, and what ends a preparation: then there is none, and what the one before
    /// had is kept for the next one. Where a first glance at its light is all that there is yet, complete()
    /// and makeSolver() are to follow.
    void make(const vk::Device& device, const Start& start);
    /// Tells whether there is a first glance at the light of a bake that is to be completed.
    bool isGlance() const { return baker_ && !baker_->isWhole(); }
    /// Finds what such a bake lacks. Throws likewise, and leaves the glance then.
    void complete();
    /// Makes it anew as it is, with the shaders as they are now. Throws likewise.
    void makeAgain(const vk::Device& device);
    /// Makes another solver, which starts from no light.
    void makeSolver();
    /// Gives up the bake.
    void end();

private:
    void keepFormer(const vk::Device& device);
    void makeBaker(const vk::Device& device, WorldMesh mesh, Preparation preparation);
    void tellPatches() const;
    void weighLights();

    Scene scene_;                      // with the edits; the baker changes it
    LightmapAtlas atlas_;              // of the scene
    uint64_t paint_ = 0;               // as the start had it
    BakeRecipe recipe_;                // surfaces: 0 where there is no bake, or it was given up
    LightMix mix_;                     // of its lights, which each solver is told
    bool due_ = false;                 // the recipe was taken up, and nothing was made by it yet
    bool wantsLayers_ = true;          // they are asked for, even if the settings cannot have them
    bool goesOn_ = false;              // with layers of the bake before
    std::unique_ptr<Baker> baker_;     // of scene_
    std::optional<FormerBake> former_; // until a bake went on with it
};

} // namespace relume
