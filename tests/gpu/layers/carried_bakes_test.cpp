// Meshes, materials and lists of objects are edited while layers are baked: another bake goes on with what
// stays, and is held against a fresh bake of what that leads to.
#include "assets/atlas/lightmap_atlas.h"
#include "bake/layers/layer_solver.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/edited_layers.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// This is an instance of the room below, behind its furniture.
constexpr size_t kCarriedPicture = kBlockEnd;

int pictureIn(Scene& scene, uint8_t red) {
    scene.images.push_back(
        {.name = "Picture", .width = 2, .height = 1, .rgba = {red, 200, 0, 255, 0, 20, red, 255}});
    scene.textures.push_back({.image = static_cast<int>(scene.images.size()) - 1, .nearest = true});
    return static_cast<int>(scene.textures.size()) - 1;
}

/// Makes the furnished room with a picture on the wall and two lamps.
Scene carriedRoom() {
    SceneMaker maker = furnishedRoom();
    Material painted;
    painted.metallic = 0.0f;
    maker.quad({0.5f, 0.01f, 0.5f}, 0.6f * kZ, 0.6f * kX, maker.material(painted), glm::uvec2(6));
    Scene scene = maker.scene();
    scene.materials.back().baseColorTexture.texture = pictureIn(scene, 90);
    scene.lights = {bulbInRoom(), panelInRoom()};
    return scene;
}

/// Follows any edit of `scene` by a bake that goes on with the one before.
class CarriedBake : public EditedLayers {
public:
    explicit CarriedBake(Scene start, const BakeDesc& desc = kEditedDesc)
        : EditedLayers(std::move(start), desc) {}

    CarriedBake& finish() {
        EditedLayers::finish();
        return *this;
    }
    void steps(int count) {
        for (; count > 0 && !solver().done(); --count)
            solver().step();
    }
    /// Edits the bake that there is; needs no other patches.
    void edit() {
        rest();
        const LightmapAtlas atlas = buildAtlas(scene, desc_.size);
        ASSERT_EQ(baker_->apply({.scene = editsOf(scene), .mix = {}, .atlas = &atlas}), Applied::Now);
    }
    /// Edits the bake that there is, whose materials are painted otherwise now.
    Applied repaint() {
        rest();
        const LightmapAtlas atlas = buildAtlas(scene, desc_.size);
        return baker_->apply({.scene = editsOf(scene), .mix = {}, .atlas = &atlas, .repainted = &scene});
    }
    /// Goes on with another bake, which has so many bytes of the former layers and links.
    void goOn(uint64_t bytes = UINT64_MAX) {
        std::optional<FormerBake> former = baker_->release();
        ASSERT_TRUE(former);
        baker_.reset();
        former->scene = std::move(*baked_);
        former->layers.keepWithin(bytes);
        *baked_ = scene;
        baker_ = std::make_unique<Baker>(testDevice(), *baked_, BakeSurfaces(meshOfScene(), &*former),
                                         settingsOf(desc_));
    }

private:
    WorldMesh meshOfScene() const { return flatten(scene, buildAtlas(scene, desc_.size)); }
};

/// Follows the scene to its end and compares every texel of every layer with a fresh bake of it. Returns the
/// share of a fresh bake's rays that it took.
double carried(CarriedBake& bake) {
    const uint64_t before = bake.rays();
    bake.goOn();
    if (testing::Test::HasFatalFailure()) return 1.0;
    bake.finish();
    const uint64_t rays = bake.rays() - before;
    CarriedBake fresh(bake.scene, bake.desc());
    fresh.finish();
    expectFresh(bake, fresh);
    const PatchSet &patches = bake.baker().patches(), &wanted = fresh.baker().patches();
    EXPECT_EQ(patches.coverCells, wanted.coverCells);
    EXPECT_EQ(patches.reach, wanted.reach);
    return static_cast<double>(rays) / static_cast<double>(fresh.rays());
}

void removeObjects(Scene& scene, size_t first, size_t last) {
    scene.instances.erase(scene.instances.begin() + static_cast<std::ptrdiff_t>(first),
                          scene.instances.begin() + static_cast<std::ptrdiff_t>(last));
}

Primitive& shapeOf(Scene& scene, size_t object) {
    return scene.meshes[static_cast<size_t>(scene.instances[object].mesh)].primitives.front();
}

/// Takes away one of an object's triangles.
void cut(Scene& scene, size_t object) {
    Primitive& shape = shapeOf(scene, object);
    shape.indices.resize(shape.indices.size() - 3);
}

/// Runs with the host's tracer and gather, and with every tracer of the device and the device's gather.
class CarriedBakes : public testing::TestWithParam<int> {
protected:
    static BakeDesc desc() {
        BakeDesc desc = kEditedDesc;
        const std::vector<TracerKind> tracers = tracersOfTestDevice();
        if (GetParam() == 0) return desc;
        desc.tracer = tracers[static_cast<size_t>(GetParam() - 1) % tracers.size()];
        desc.deviceGather = true;
        return desc;
    }
    /// As in ObjectEdits.
    static double few(double share) {
        return GetParam() == 0 && testDevice().info().software() ? share : 1.0;
    }
};

} // namespace

TEST_P(CarriedBakes, NothingNewCostsNothing) {
    CarriedBake bake(carriedRoom(), desc());
    bake.finish();
    std::reverse(bake.scene.instances.begin(), bake.scene.instances.end());
    for (Instance& instance : bake.scene.instances)
        instance.name += " renamed";
    bake.scene.materials.emplace_back().name = "Not used";
    EXPECT_EQ(carried(bake), 0.0);
}

TEST_P(CarriedBakes, APictureOrARoughnessCostsNoRay) {
    CarriedBake bake(carriedRoom(), desc());
    bake.finish();
    bake.scene.images.front().rgba[0] = 255;
    EXPECT_EQ(carried(bake), 0.0);
    bake.scene.materials.front().metallic = 0.6f;
    bake.scene.materials.front().roughness = 0.2f;
    EXPECT_EQ(carried(bake), 0.0);
}

// The patches that there are get other patterns: no other bake is needed.
TEST_P(CarriedBakes, WhatIsPaintedOtherwiseIsAnEdit) {
    CarriedBake bake(carriedRoom(), desc());
    bake.finish();
    const uint64_t rays = bake.rays();
    bake.scene.images.insert(bake.scene.images.begin(), bake.scene.images.front());
    for (Texture& texture : bake.scene.textures)
        ++texture.image; // another number of the same picture, which changes nothing
    bake.scene.materials.front().metallic = 0.6f;
    bake.scene.materials.front().roughness = 0.2f;
    ASSERT_EQ(bake.repaint(), Applied::Now);
    bake.finish();
    EXPECT_EQ(bake.rays(), rays);
    CarriedBake metal(bake.scene, bake.desc());
    expectFresh(bake, metal.finish());

    bake.scene.images.back().rgba[0] = 255;
    bake.scene.instances[kShelf].hidden = true;
    ASSERT_EQ(bake.repaint(), Applied::Now);
    bake.scene.materials[2].metallic = 0.5f; // of the shelf, which nobody sees
    ASSERT_EQ(bake.repaint(), Applied::Now);
    bake.scene.instances[kShelf].hidden = false;
    bake.edit();
    bake.finish();
    CarriedBake fresh(bake.scene, bake.desc());
    expectFresh(bake, fresh.finish());
    EXPECT_EQ(bake.baker().patches().albedoPattern, fresh.baker().patches().albedoPattern);
}

TEST_P(CarriedBakes, AChangedMeshCostsItsOwn) {
    CarriedBake bake(carriedRoom(), desc());
    bake.finish();
    for (glm::vec3& position : shapeOf(bake.scene, kShelf).positions)
        position.z += 0.1f * position.x;
    EXPECT_LT(carried(bake), few(0.7));
    cut(bake.scene, kBlock);
    EXPECT_LT(carried(bake), few(0.4)) << "it has fewer triangles";
}

TEST_P(CarriedBakes, ObjectsComeAndGo) {
    CarriedBake bake(carriedRoom(), desc());
    bake.finish();
    const Scene all = bake.scene;
    removeObjects(bake.scene, kBlock, kCarriedPicture);
    EXPECT_LT(carried(bake), few(0.5));
    bake.scene = all;
    EXPECT_LT(carried(bake), few(0.6));
    bake.scene.instances[kShelf].hidden = true;
    EXPECT_LT(carried(bake), few(0.7));
}

TEST_P(CarriedBakes, ALightOfAnotherFormIsMadeAnew) {
    CarriedBake bake(carriedRoom(), desc());
    bake.finish();
    for (glm::vec3& position : shapeOf(bake.scene, kPlate).positions)
        position.x *= 1.2f;
    carried(bake);
    bake.scene.materials[1].emissionTexture.texture = pictureIn(bake.scene, 255);
    carried(bake);
    removeObjects(bake.scene, kPlate, kPlate + 1);
    carried(bake);
}

INSTANTIATE_TEST_SUITE_P(Tracers, CarriedBakes, testing::Range(0, 4));

// A viewer sees what it saw, in its new places, until there is better.
TEST(CarriedBakes, WhatWasShownIsShownOn) {
    BakeDesc desc = kEditedDesc;
    desc.live = true;
    CarriedBake bake(carriedRoom(), desc);
    bake.finish();
    const FloatImage before = bake.baker().lightmap({.sew = false});
    removeObjects(bake.scene, kCarriedPicture, kCarriedPicture + 1);
    bake.goOn();
    EXPECT_TRUE(bake.solver().liveLight().complete);
    EXPECT_FALSE(bake.solver().current());
    const FloatImage after = bake.baker().lightmap({.sew = false});
    size_t covered = 0;
    for (size_t texel = 0; texel < after.planes[0].size(); ++texel) {
        // What lay inside the picture that went had no light to show.
        if (after.planes[0][texel] <= 0.0f || before.planes[0][texel] <= 0.0f) continue;
        ++covered;
        EXPECT_FLOAT_EQ(after.planes[0][texel], before.planes[0][texel]) << texel;
    }
    EXPECT_GT(covered, kRoomSize * kRoomSize / 5);
    bake.finish();
    EXPECT_TRUE(bake.solver().current());
    CarriedBake fresh(bake.scene, desc);
    expectFresh(bake, fresh.finish());
}

// Edits of all kinds come before the ones before were followed to their end.
TEST(CarriedBakes, EditsUnderWayComeAlong) {
    BakeDesc desc = kEditedDesc;
    desc.live = true;
    desc.batchMs = 1.0;
    CarriedBake bake(carriedRoom(), desc);
    bake.finish();
    for (int i = 0; i < 4; ++i) {
        for (size_t k = kBlock; k < kCarriedPicture; ++k)
            bake.scene.instances[k].transform =
                glm::translate(bake.scene.instances[k].transform, {0.1f, -0.05f, 0.02f});
        bake.edit();
        bake.steps(2 * i);
        shapeOf(bake.scene, kShelf).positions.front().z += 0.05f;
        bake.goOn();
        bake.steps(3 * i);
        bake.scene.lights[0].transform = at({0.6f + 0.1f * static_cast<float>(i), 0.5f, 1.2f});
        bake.edit();
        bake.steps(i);
    }
    carried(bake);
}

TEST(CarriedBakes, HiddenAndMovedObjectsAreWhereTheyAre) {
    CarriedBake bake(carriedRoom());
    bake.finish();
    bake.scene.instances[kShelf].hidden = true;
    bake.scene.instances[kCarriedPicture].transform = at({0.2f, 0.0f, 0.1f});
    bake.edit();
    bake.finish();
    cut(bake.scene, kBlock);
    EXPECT_LT(carried(bake), 0.5);
    bake.scene.instances[kShelf].hidden = false;
    EXPECT_LT(carried(bake), 0.7);
}

// The sky and the sun come from all around; an object beyond all others makes the scene another size.
TEST(CarriedBakes, UnderSkyAndSun) {
    SceneMaker maker(32);
    maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(16));
    maker.quad({0, -1, 0}, 1.0f * kZ, 2.0f * kY, maker.material(0.5f), glm::uvec2(8));
    maker.quad({-0.5f, -0.5f, 0.3f}, 0.3f * kX, 0.3f * kY, maker.material(0.5f), glm::uvec2(4));
    Scene scene = maker.scene();
    scene.sky.radiance = glm::vec3(2.0f);
    Light sun = lightAt(LightType::Directional, {}, 5.0f, "Sun");
    sun.transform = glm::rotate(glm::mat4(1.0f), 0.4f, kY);
    sun.angle = 0.02f;
    scene.lights.push_back(sun);
    BakeDesc desc = kEditedDesc;
    desc.size = 32;
    CarriedBake bake(scene, desc);
    bake.finish();
    for (glm::vec3& position : shapeOf(bake.scene, 2).positions)
        position.y += 0.2f;
    EXPECT_LT(carried(bake), 0.9);
    for (glm::vec3& position : shapeOf(bake.scene, 1).positions)
        position.x += 3.0f;
    carried(bake);
}

TEST(CarriedBakes, HolesAreComparedAsRaysMeetThem) {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.6f), 12);
    Material leaf;
    leaf.metallic = 0.0f;
    leaf.alphaMode = AlphaMode::Mask;
    leaf.baseColorTexture.texture = maker.alphaTexture(2, 2, {255, 0, 0, 255});
    maker.quad({0.7f, 0.7f, 1.0f}, 0.6f * kX, 0.6f * kY, maker.material(leaf), glm::uvec2(8));
    maker.blocker({0.2f, 0.2f, 0.6f}, 0.4f * kX, 0.4f * kY, maker.material(0.5f));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.0f, 1.0f, 1.8f}, 3.0f, "Bulb"));
    CarriedBake bake(scene);
    bake.finish();
    for (glm::vec3& position : shapeOf(bake.scene, 7).positions)
        position.x += 0.3f;
    carried(bake);
    bake.scene.images.front().rgba[3] = 0;
    carried(bake);
    bake.scene.materials[1].alphaCutoff = 0.2f;
    carried(bake);
}

TEST(CarriedBakes, TexelsInsideSomethingAreFoundAnew) {
    CarriedBake bake(carriedRoom());
    bake.finish();
    const uint32_t before = bake.baker().invalidPatches();
    for (size_t k = kBlock; k < kCarriedPicture; ++k)
        for (glm::vec3& position : shapeOf(bake.scene, k).positions)
            position.z -= 0.2f;
    carried(bake);
    EXPECT_GT(bake.baker().invalidPatches(), before + 5);
    removeObjects(bake.scene, kBlock, kCarriedPicture);
    carried(bake);
    EXPECT_LE(bake.baker().invalidPatches(), before);
}

// A wall that is thinner than a texel stands on the middles of the floor's.
TEST_P(CarriedBakes, PatchesStepAsideAnew) {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.6f), 12);
    maker.box({0.36f, 0.3f, -0.1f}, {1.4f * kY, 0.12f * kX, 1.3f * kZ}, maker.material(0.5f), 6);
    maker.quad({1.2f, 0.3f, 0.7f}, 0.5f * kX, 0.9f * kY, maker.material(0.3f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.0f, 1.0f, 1.5f}, 3.0f, "Bulb"));
    CarriedBake bake(scene, desc());
    bake.finish();
    const size_t first = bake.baker().patches().aside.size();
    EXPECT_GE(first, 5u);
    shapeOf(bake.scene, 12).positions.front().z += 0.05f; // far from those that have stepped aside
    carried(bake);
    EXPECT_EQ(bake.baker().patches().aside.size(), first);
    for (size_t k = 6; k < 12; ++k)
        for (glm::vec3& position : shapeOf(bake.scene, k).positions)
            position.x += 0.03f;
    carried(bake);
    bake.scene.materials.front().baseColor *= 0.5f; // nothing moves
    carried(bake);
    removeObjects(bake.scene, 6, 12);
    carried(bake);
    EXPECT_LT(bake.baker().patches().aside.size(), first);
}

TEST(CarriedBakes, WhatMemoryIsShortForIsMadeAgain) {
    CarriedBake bake(carriedRoom());
    for (const uint64_t bytes : {uint64_t{0}, uint64_t{600'000}}) {
        bake.finish();
        shapeOf(bake.scene, kShelf).positions.front().z += 0.05f;
        bake.goOn(bytes);
        bake.finish();
        CarriedBake fresh(bake.scene);
        expectFresh(bake, fresh.finish());
    }
}

// A viewer goes on showing what it showed until there is a whole picture.
TEST(CarriedBakes, TheFirstNewPictureIsOfAllLightsAtOnce) {
    BakeDesc desc = kEditedDesc;
    desc.live = true;
    CarriedBake bake(carriedRoom(), desc);
    bake.finish();
    cut(bake.scene, kBlock);
    bake.goOn();
    while (!bake.solver().current()) {
        EXPECT_TRUE(bake.solver().liveLight().complete) << "as it was before";
        bake.solver().step();
    }
    EXPECT_TRUE(bake.solver().liveLight().complete);
    const Light4 first = bake.solver().light();
    bake.finish();
    EXPECT_LT(distance(first, bake.solver().light()), 0.03) << "of all lights at once";
    // With all layers there is one at once.
    bake.goOn();
    EXPECT_TRUE(bake.solver().current());
}

// Two hundred changes of all kinds, drawn by chance, come one after the other and under way. The light that
// they lead to is a fresh bake's.
TEST(CarriedBakes, TwoHundredChangesAreAFreshBake) {
    BakeDesc desc = kEditedDesc;
    desc.live = true;
    CarriedBake bake(carriedRoom(), desc);
    const Scene home = bake.scene;
    std::mt19937 random(7);
    const auto share = [&] { return static_cast<float>(random()) * 0x1p-32f; };
    size_t wentOn = 0;
    for (int change = 0; change < 200; ++change) {
        Scene& scene = bake.scene;
        const glm::vec3 way = 0.3f * (glm::vec3(share(), share(), share()) - 0.5f);
        const size_t kind = random() % 8, object = kPlate + random() % 3;
        const auto found = [&](const std::string& name) {
            return std::find_if(scene.instances.begin(), scene.instances.end(),
                                [&](const Instance& instance) { return instance.name == name; });
        };
        const auto own = found(home.instances[object].name);
        const bool there = own != scene.instances.end();
        switch (kind) {
        case 0:
            scene.lights[0].transform = at(glm::vec3(1.2f) + way);
            break;
        case 1:
            scene.lights[1].intensity = 1.0f + 30.0f * share();
            break;
        case 2:
            scene.materials[0].baseColor = {share(), share(), share(), 1.0f};
            break;
        case 3:
            if (there) own->transform = at(way);
            break;
        case 4:
            if (there) scene.instances.erase(own);
            break;
        case 5:
            if (!there) scene.instances.push_back(home.instances[object]);
            break;
        case 6:
            if (there)
                for (glm::vec3& position :
                     shapeOf(scene, static_cast<size_t>(own - scene.instances.begin())).positions)
                    position += 0.1f * way * position;
            break;
        default:
            scene.images.front().rgba[random() % 3] = static_cast<uint8_t>(random());
            break;
        }
        if (kind < 4) {
            bake.edit();
        } else {
            bake.goOn();
            ++wentOn;
        }
        if (HasFatalFailure()) return;
        bake.steps(static_cast<int>(random() % 12));
    }
    EXPECT_GT(wentOn, 60u);
    bake.finish();
    CarriedBake fresh(bake.scene, desc);
    expectFresh(bake, fresh.finish());
}

} // namespace relume
