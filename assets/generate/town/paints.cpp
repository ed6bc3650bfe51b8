#include "assets/generate/town/paints.h"

#include "assets/generate/town/town_pixels.h"

namespace relume::generate {
namespace {

void makeStones(SceneBuilder& builder, TownPaints& paints) {
    const glm::vec3 plasters[kPlasters] = {{0.88f, 0.74f, 0.50f},
                                           {0.86f, 0.62f, 0.52f},
                                           {0.88f, 0.85f, 0.78f},
                                           {0.74f, 0.78f, 0.66f},
                                           {0.84f, 0.55f, 0.36f}};
    const char* names[kPlasters] = {"Ochre plaster", "Rose plaster", "White plaster", "Sage plaster",
                                    "Red plaster"};
    for (int i = 0; i < kPlasters; ++i)
        paints.plaster[i] = builder.textured(names[i], plasterPicture(plasters[i], 200 + 20 * i), {3.0, 3.0});
    paints.ashlar = builder.textured("Ashlar", ashlarPicture(), {1.6, 1.6});
    paints.stone = builder.paint("Limestone", {0.58f, 0.53f, 0.45f});
    paints.brick = builder.textured("Brick", brickPicture(), {1.0, 0.6});
    paints.cobbles = builder.textured("Cobbles", cobblePicture(), {1.2, 1.2});
    paints.flags = builder.textured("Flagstones", flagPicture(), {1.6, 1.6});
    paints.tiles = builder.textured("Roof tiles", rooftilePicture(), {2.0, 2.1});
    paints.tileRows = builder.paint("Pantiles", {0.44f, 0.17f, 0.09f});
    paints.terracotta = builder.paint("Terracotta", {0.48f, 0.21f, 0.12f});
    paints.soil = builder.paint("Soil", {0.09f, 0.06f, 0.04f});
    paints.water = builder.paint("Water", {0.05f, 0.09f, 0.09f});
}

void makeWoods(SceneBuilder& builder, TownPaints& paints) {
    paints.boards = builder.textured("Floor boards", boardPicture({0.62f, 0.46f, 0.32f}), {0.8, 2.4});
    paints.planks = builder.textured("Planks", boardPicture({0.66f, 0.54f, 0.40f}), {0.6, 1.8});
    paints.timber = builder.paint("Timber", {0.16f, 0.10f, 0.06f});
    paints.green = builder.paint("Green paint", {0.08f, 0.20f, 0.12f});
    paints.blue = builder.paint("Blue paint", {0.10f, 0.20f, 0.34f});
    paints.white = builder.paint("White paint", {0.72f, 0.70f, 0.66f});
    paints.brown = builder.paint("Brown paint", {0.22f, 0.12f, 0.07f});
    paints.darkGlass = builder.paint("Dark panes", {0.03f, 0.04f, 0.05f});
    paints.glass = builder.glass("Glass", {0.80f, 0.88f, 0.86f, 0.15f});
    paints.iron = builder.paint("Iron", {0.06f, 0.06f, 0.07f});
    paints.brass = builder.paint("Brass", {0.55f, 0.38f, 0.14f});
}

void makeRest(SceneBuilder& builder, TownPaints& paints) {
    paints.leaves = builder.masked("Leaves", leafPicture(), {1.0, 1.0});
    paints.ivy = builder.masked("Ivy", ivyPicture(), {1.2, 1.2});
    paints.flowers = builder.masked("Flowers", flowerPicture(), {0.5, 0.5});
    paints.grille = builder.masked("Grille", grillePicture(), {0.8, 0.8});
    paints.stripes = builder.textured("Canvas", stripePicture(), {0.5, 0.5});
    paints.rug = builder.textured("Rug", rugPicture(), {2.4, 1.4});
    paints.books = builder.textured("Books", bookPicture(), {1.6, 0.34});
    paints.inside = builder.paint("Limewash", {0.72f, 0.69f, 0.62f});
    paints.wallpaper = builder.paint("Green wall", {0.30f, 0.38f, 0.28f});
    const glm::vec3 fruits[kFruits] = {
        {0.55f, 0.06f, 0.04f}, {0.68f, 0.28f, 0.04f}, {0.30f, 0.42f, 0.07f}, {0.66f, 0.52f, 0.08f}};
    const char* names[kFruits] = {"Apples", "Oranges", "Limes", "Lemons"};
    for (int i = 0; i < kFruits; ++i)
        paints.fruit[i] = builder.paint(names[i], fruits[i]);
    paints.cloth = {builder.paint("Linen", {0.72f, 0.69f, 0.62f}),
                    builder.paint("Blue cloth", {0.16f, 0.26f, 0.48f}),
                    builder.paint("Red cloth", {0.52f, 0.10f, 0.09f})};
    paints.glow = builder.lamp("Bulbs", {4200.0f, 3000.0f, 1700.0f});
}

} // namespace

TownPaints makeTownPaints(SceneBuilder& builder) {
    TownPaints paints;
    makeStones(builder, paints);
    makeWoods(builder, paints);
    makeRest(builder, paints);
    return paints;
}

} // namespace relume::generate
