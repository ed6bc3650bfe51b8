#pragma once

// Here are a furnished room, a bake of its layers whose scene is edited, and how both are held against a
// fresh bake.
#include "tests/gpu/layered.h"

namespace relume {

inline constexpr uint32_t kRoomSize = 64; // edge of its lightmap [texels]
// These are instances of the room below, behind its six walls. The block has six sides.
inline constexpr size_t kPlate = 6, kShelf = 7, kBlock = 8, kBlockEnd = 14;

/// Makes a closed room of 2 m with a plate that shines [cd/m^2], a shelf and a block, each in a place of its
/// own in the lightmap.
inline SceneMaker furnishedRoom(float plate = 8.0f) {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.6f), 12);
    maker.quad({0.6f, 0.6f, 1.9f}, 0.4f * kY, 0.4f * kX, maker.material(0.0f, plate), glm::uvec2(4));
    maker.quad({1.2f, 0.3f, 0.7f}, 0.5f * kX, 0.9f * kY, maker.material(0.3f), glm::uvec2(8));
    // Left-handed edges turn fronts outwards.
    maker.box({0.2f, 1.2f, 0.05f}, {0.3f * kY, 0.3f * kX, 0.3f * kZ}, maker.material(0.5f), 4);
    return maker;
}

inline constexpr BakeDesc kEditedDesc{
    .size = kRoomSize, .passes = 0, .method = Method::Hybrid, .samples = 32, .smooth = true, .layers = true};

/// Holds a bake of layers. Its scene is edited, and those who derive from it say how the bake follows.
class EditedLayers {
public:
    EditedLayers(Scene start, const BakeDesc& desc)
        : scene(std::move(start)), desc_(desc), baked_(std::make_unique<Scene>(scene)),
          baker_(makeEditableBaker(*baked_, desc)) {}

    LayerSolver& solver() { return *baker_->layers(); }
    Baker& baker() { return *baker_; }
    const BakeDesc& desc() const { return desc_; }
    uint64_t rays() { return solver().raysSoFar(); }
    void finish() {
        while (!solver().done())
            solver().step();
    }
    void rest() {
        while (!solver().atRest())
            solver().step();
    }
    /// Returns the image of the composite, then those of the layers.
    std::vector<FloatImage> images() {
        std::vector<FloatImage> all = {baker_->lightmap({.sew = false})};
        for (const auto& layer : solver().layers())
            all.push_back(makeLightmap(baker_->patches(), solver().layerLight(*layer), {.sew = false}));
        return all;
    }

    Scene scene;

protected:
    BakeDesc desc_;
    std::unique_ptr<Scene> baked_;
    std::unique_ptr<Baker> baker_;
};

/// Compares every texel of every layer with those of a fresh bake, and which patches lie inside something.
inline void expectFresh(EditedLayers& bake, EditedLayers& fresh) {
    const std::vector<FloatImage> edited = bake.images(), wanted = fresh.images();
    ASSERT_EQ(edited.size(), wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i)
        EXPECT_TRUE(edited[i].planes == wanted[i].planes)
            << "image " << i << " is off by " << relativeError(edited[i], wanted[i]);
    EXPECT_EQ(bake.baker().invalidPatches(), fresh.baker().invalidPatches());
}

} // namespace relume
