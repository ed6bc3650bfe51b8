#include "assets/generate/town/props.h"

#include "assets/generate/shapes/furniture.h"
#include "assets/generate/shapes/paint_image.h"

#include <cmath>

namespace relume::generate {
namespace {

Solid barrelSolid(const TownPaints& paints) {
    std::vector<glm::dvec2> staves, profile;
    constexpr int kRows = 10;
    for (int i = 0; i <= kRows; ++i) {
        const double t = 2.0 * i / kRows - 1.0;
        staves.emplace_back(0.33 - 0.07 * t * t, 0.45 - 0.45 * t);
    }
    Solid solid = lathe(staves, 20).paint(paints.planks);
    profile = {{0.0, 0.861}, {0.241, 0.861}, {0.243, 0.9}, {0.261, 0.9}};
    solid.add(lathe(profile, 20).paint(paints.timber));
    for (double y : {0.07, 0.25, 0.6, 0.78}) {
        const auto radius = [](double h) { return 0.33 - 0.07 * (h - 0.45) * (h - 0.45) / 0.2025; };
        solid.add(lathe({{radius(y + 0.05) - 0.004, y + 0.05},
                         {radius(y + 0.05) + 0.009, y + 0.048},
                         {radius(y) + 0.009, y + 0.002},
                         {radius(y) - 0.004, y}},
                        20)
                      .paint(paints.iron));
    }
    return solid;
}

Solid crateSolid(const TownPaints& paints) {
    Solid solid;
    constexpr double kHalf = 0.34, kHeight = 0.56;
    for (int side = 0; side < 4; ++side) {
        const Frame frame{{0, 0, 0}, side};
        for (int i = 0; i < 3; ++i)
            solid.add(frame.put(block({-kHalf + 0.03, 0.03 + 0.18 * i, kHalf - 0.04},
                                      {kHalf - 0.03, 0.03 + 0.18 * i + 0.155, kHalf - 0.015})));
        solid.add(frame.put(block({kHalf - 0.075, 0.0, kHalf - 0.075}, {kHalf, kHeight, kHalf})));
    }
    return solid.add(block({-kHalf + 0.035, 0.04, -kHalf + 0.035}, {kHalf - 0.035, 0.4, kHalf - 0.035}))
        .paint(paints.planks);
}

Solid benchSolid(const TownPaints& paints) {
    Solid solid;
    for (int i = 0; i < 4; ++i)
        solid.add(block({-0.85, 0.41, -0.19 + 0.11 * i}, {0.85, 0.445, -0.19 + 0.11 * i + 0.09}));
    for (int i = 0; i < 3; ++i)
        solid.add(block({-0.85, 0.55 + 0.13 * i, -0.255}, {0.85, 0.55 + 0.13 * i + 0.1, -0.225}));
    solid.paint(paints.planks);
    for (double x : {-0.66, 0.66}) {
        Solid leg = block({x - 0.03, -0.02, 0.1}, {x + 0.03, 0.42, 0.16});
        leg.add(block({x - 0.03, -0.02, -0.29}, {x + 0.03, 0.96, -0.25}));
        leg.add(block({x - 0.025, 0.355, -0.26}, {x + 0.025, 0.415, 0.2}));
        solid.add(leg.paint(paints.iron));
    }
    return solid;
}

// Returns two crossed cards of foliage, upright, around the origin.
Solid crossedCards(double width, double height, int material) {
    Solid solid;
    for (double turn : {20.0, 110.0})
        solid.add(quad({-width / 2, height, 0}, {width, 0, 0}, {0, -height, 0}).turnY(turn));
    return solid.paint(material);
}

Solid planterSolid(const TownPaints& paints) {
    Solid solid = lathe({{0.0, 0.57},
                         {0.31, 0.56},
                         {0.322, 0.63},
                         {0.367, 0.64},
                         {0.377, 0.57},
                         {0.337, 0.541},
                         {0.317, 0.421},
                         {0.271, 0.241},
                         {0.227, 0.121},
                         {0.223, 0.077},
                         {0.261, 0.051},
                         {0.267, -0.03}},
                        24)
                      .paint(paints.terracotta);
    for (int i = 0; i < 9; ++i) {
        const double angle = 2.4 * i, out = 0.085 * std::sqrt(double(i));
        Solid tuft = crossedCards(0.5, 0.5, i % 3 == 0 ? paints.flowers : paints.leaves);
        for (Chart& chart : tuft.charts)
            for (ChartVertex& vertex : chart.vertices)
                vertex.texCoord *= i % 3 == 0 ? 1.0 : 2.0; // a whole picture per card
        solid.add(
            tuft.turnY(40.0 * i).move({out * std::cos(angle), 0.52 + 0.04 * (i % 4), out * std::sin(angle)}));
    }
    return solid;
}

Solid flowerBoxSolid(const TownPaints& paints) {
    Solid solid = block({-0.52, 0.0, 0.0}, {0.52, 0.19, 0.2}).paint(paints.terracotta);
    for (int i = 0; i < 6; ++i)
        solid.add(quad({-0.25, 0.42, 0}, {0.5, 0, 0}, {0, -0.42, 0})
                      .turnY(i % 2 ? 62.0 : -48.0)
                      .move({-0.42 + 0.168 * i, 0.12, 0.1})
                      .paint(paints.flowers));
    return solid;
}

// Makes an open lantern, its floor at the origin: the light hangs free in its middle, below a bulb.
Solid lanternHead(const TownPaints& paints) {
    Solid solid = lathe({{0.0, 0.62},
                         {0.022, 0.6},
                         {0.031, 0.56},
                         {0.051, 0.53},
                         {0.171, 0.45},
                         {0.221, 0.4},
                         {0.217, 0.38},
                         {0.0, 0.391}},
                        16);
    solid.add(lathe({{0.0, 0.041}, {0.117, 0.037}, {0.127, 0.011}, {0.061, -0.049}, {0.0, -0.061}}, 16));
    for (int i = 0; i < 6; ++i) {
        const double a = kTwoPi * i / 6;
        const glm::dvec3 foot(0.107 * std::cos(a), 0.02, 0.107 * std::sin(a)),
            head(0.197 * std::cos(a), 0.4, 0.197 * std::sin(a));
        solid.add(lathe({{0.009, 1.0}, {0.009, 0.0}}, 5, [&](double angle, const glm::dvec2& p) {
            return foot + p.y * (head - foot) + glm::dvec3(p.x * std::sin(angle), 0, p.x * std::cos(angle));
        }));
    }
    solid.paint(paints.iron);
    return solid.add(globe(0.037, 10, 6).move({0, 0.335, 0}).paint(paints.glow));
}

Solid lanternSolid(const TownPaints& paints) {
    Solid solid = lathe({{0.055, 3.08},
                         {0.06, 3.02},
                         {0.034, 2.98},
                         {0.033, 2.61},
                         {0.051, 2.58},
                         {0.051, 2.53},
                         {0.036, 2.5},
                         {0.047, 1.02},
                         {0.083, 0.97},
                         {0.087, 0.91},
                         {0.063, 0.86},
                         {0.071, 0.41},
                         {0.121, 0.31},
                         {0.131, 0.09},
                         {0.187, 0.05},
                         {0.191, -0.1}},
                        16)
                      .paint(paints.iron);
    return solid.add(lanternHead(paints).move({0, 3.12, 0}));
}

// Makes a lantern on a bracket: the wall at z = 0, the light 0.62 m in front of it.
Solid bracketSolid(const TownPaints& paints) {
    Solid solid = block({-0.06, -0.02, -0.01}, {0.06, 0.5, 0.03});
    solid.add(grid({.columns = 8, .rows = 12, .closedS = true}, [](double s, double t) {
                  const double a = kTwoPi * s, z = 0.02 + 0.6 * t, y = 0.34 + 0.22 * t * (2.0 - t);
                  return glm::dvec3(0.014 * std::cos(a), y - 0.014 * std::sin(a), z);
              }).paint(paints.iron));
    solid.paint(paints.iron);
    return solid.add(lanternHead(paints).move({0, -0.06, 0.62}));
}

// Cards of leaves on a ball around (0, y, 0), each turned its own way.
Solid crown(const TownPaints& paints, double y, double radius, int cards) {
    Solid solid;
    for (int i = 0; i < cards; ++i) {
        // Points spread evenly over a ball: the golden angle about Y.
        const double height = 1.0 - 2.0 * (i + 0.5) / cards, angle = 2.399963 * i;
        const double ring = std::sqrt(1.0 - height * height);
        const double out = radius * (0.45 + 0.55 * std::sqrt(random(i, 1, 131)));
        const glm::dvec3 at(out * ring * std::cos(angle), y + 0.8 * out * height,
                            out * ring * std::sin(angle));
        const double size = 0.75 + 0.35 * random(i, 2, 131), lean = 40.0 + 70.0 * random(i, 3, 131);
        const double c = std::cos(glm::radians(lean)), s = std::sin(glm::radians(lean));
        Solid card = quad({-0.5, 0.5, 0}, {1, 0, 0}, {0, -1, 0}).turn(glm::dmat3(size));
        solid.add(card.turn(glm::dmat3({1, 0, 0}, {0, c, s}, {0, -s, c}))
                      .turnY(360.0 * random(i, 4, 131))
                      .move(at));
    }
    return solid.paint(paints.leaves);
}

Solid limb(const glm::dvec3& from, const glm::dvec3& to, double thick, double thin, int segments) {
    return lathe({{0.0, 1.0}, {thin, 1.0}, {0.5 * (thick + thin), 0.5}, {thick, 0.0}}, segments,
                 [&](double angle, const glm::dvec2& p) {
                     const double bow = 0.12 * std::sin(kPi * p.y);
                     return from + p.y * (to - from) +
                            glm::dvec3(p.x * std::sin(angle) + bow, 0, p.x * std::cos(angle));
                 });
}

Solid treeSolid(const TownPaints& paints) {
    Solid wood = lathe(
        {{0.0, 2.31}, {0.11, 2.3}, {0.13, 1.6}, {0.14, 0.9}, {0.17, 0.35}, {0.24, 0.08}, {0.32, -0.06}}, 14);
    for (int i = 0; i < 6; ++i) {
        const double a = 1.05 * i, reach = 0.9 + 0.35 * random(i, 1, 141);
        wood.add(limb({0.04 * std::cos(a), 1.7 + 0.09 * i, 0.04 * std::sin(a)},
                      {reach * std::cos(a), 3.0 + 0.3 * (i % 3), reach * std::sin(a)}, 0.065, 0.022, 7));
    }
    return wood.paint(paints.timber).add(crown(paints, 3.5, 1.75, 170));
}

// Makes cloth of some thickness: its front, its back at `behind`, and the rim between them.
Solid sheet(const glm::ivec2& cells, const glm::dvec3& behind, const Surface& front) {
    const GridDesc face{.columns = cells.x, .rows = cells.y};
    const auto at = [&](double s, double t, bool isBack) {
        return front(s, t) + (isBack ? behind : glm::dvec3(0.0));
    };
    Solid solid = grid(face, front);
    solid.add(grid(face, [&](double s, double t) { return at(1.0 - s, t, true); }));
    for (double side : {0.0, 1.0}) {
        solid.add(grid({.columns = 1, .rows = cells.y},
                       [&](double s, double t) { return at(side, t, s == side); }));
        solid.add(grid({.columns = cells.x, .rows = 1},
                       [&](double s, double t) { return at(s, side, t == side); }));
    }
    return solid;
}

Solid post(const glm::dvec3& low, double half, double height) {
    return block(low - glm::dvec3(half, 0, half), low + glm::dvec3(half, height, half));
}

} // namespace

void makeProps(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    SceneBuilder& builder = kit.builder;
    kit.barrel = builder.share("Barrel", barrelSolid(paints), Batched::Yes);
    kit.crate = builder.share("Crate", crateSolid(paints), Batched::Yes);
    kit.bench = builder.share("Bench", benchSolid(paints));
    kit.planter = builder.share("Planter", planterSolid(paints), Batched::Yes);
    kit.flowerBox = builder.share("Flower box", flowerBoxSolid(paints), Batched::Yes);
    kit.lantern = builder.share("Street lantern", lanternSolid(paints));
    kit.bracketLamp = builder.share("Wall lantern", bracketSolid(paints));
    kit.tree = builder.share("Tree", treeSolid(paints));
    const char* names[kFruits] = {"Apple", "Orange", "Lime", "Lemon"};
    for (int i = 0; i < kFruits; ++i)
        kit.fruit[i] = builder.share(names[i], sphere(0.052, 3).move({0, 0.045, 0}).paint(paints.fruit[i]),
                                     Batched::Yes);
}

Solid hangingCloth(double width, double drop, double wave) {
    return sheet({12, 6}, {0, 0, -0.012}, [=](double s, double t) {
        return glm::dvec3(width * (s - 0.5), -drop * t, wave * t * std::sin(kTwoPi * 1.5 * s));
    });
}

void addStall(TownKit& kit, const std::string& name, const glm::dvec3& at, double turn, int cloth) {
    const TownPaints& paints = kit.paints;
    constexpr double kHalfX = 1.2, kHalfZ = 0.7, kTop = 0.86;
    Solid solid;
    for (double x : {-kHalfX, kHalfX})
        for (double z : {-kHalfZ, kHalfZ})
            solid.add(post({x, -0.02, z}, 0.04, z > 0 ? 2.2 : 2.55));
    solid.add(block({-kHalfX - 0.06, kTop - 0.05, -kHalfZ - 0.05}, {kHalfX + 0.06, kTop, kHalfZ + 0.12}));
    solid.add(block({-kHalfX, 0.3, -kHalfZ + 0.05}, {kHalfX, 0.34, kHalfZ - 0.05})).paint(paints.planks);
    solid.add(hangingCloth(2.0 * kHalfX + 0.1, 0.62, 0.02)
                  .move({0, kTop - 0.01, kHalfZ + 0.145})
                  .paint(paints.cloth[cloth]));
    // The canvas sags between its poles; two sheets, as it is lit from both sides.
    const auto canvas = [](double s, double t) {
        const double sag = 0.09 * std::sin(kPi * s);
        return glm::dvec3((2.0 * s - 1.0) * (kHalfX + 0.18), 2.62 - 0.42 * t - sag * (0.4 + 0.6 * t),
                          -kHalfZ - 0.2 + t * (2.0 * kHalfZ + 0.55));
    };
    solid.add(sheet({16, 6}, {0, -0.015, 0}, canvas).paint(kit.paints.stripes));
    kit.builder.add(name, solid.turnY(turn), at);
    // Fruit lies in three heaps, each of one kind.
    for (int heap = 0; heap < 3; ++heap)
        for (int layer = 0; layer < 3; ++layer)
            for (int i = 0; i < 3 - layer; ++i)
                for (int k = 0; k < 5 - layer; ++k) {
                    const glm::dvec3 place(-0.75 + 0.75 * heap + 0.105 * (k - (4 - layer) / 2.0),
                                           kTop + 0.082 * layer, 0.35 + 0.105 * (i - (2 - layer) / 2.0));
                    const double a = glm::radians(turn);
                    const glm::dvec3 world(std::cos(a) * place.x + std::sin(a) * place.z, place.y,
                                           std::cos(a) * place.z - std::sin(a) * place.x);
                    kit.builder.place(kit.fruit[(heap + cloth) % kFruits], {at + world, 37.0 * (i + 3 * k)});
                }
}

void addWell(TownKit& kit, const glm::dvec3& at) {
    Solid solid = lathe({{0.71, 0.83},
                         {0.98, 0.83},
                         {1.01, 0.81},
                         {1.01, 0.71},
                         {0.95, 0.67},
                         {0.93, 0.16},
                         {1.27, 0.14},
                         {1.29, -0.06}},
                        32)
                      .paint(kit.paints.ashlar);
    solid.add(lathe({{0.69, -0.55}, {0.69, 0.8}, {0.71, 0.83}}, 32).paint(kit.paints.stone));
    solid.add(cap({0.69, -0.4}, 32, true).paint(kit.paints.water));
    for (double x : {-0.84, 0.84})
        solid.add(post({x, 0.78, 0}, 0.07, 1.45).paint(kit.paints.timber));
    solid.add(block({-1.05, 2.1, -0.08}, {1.05, 2.24, 0.08}).paint(kit.paints.timber));
    solid.add(lathe({{0.11, 0.75}, {0.11, -0.75}}, 14)
                  .turn(glm::dmat3({0, -1, 0}, {1, 0, 0}, {0, 0, 1}))
                  .move({0, 1.45, 0})
                  .paint(kit.paints.planks));
    // Two slopes of a small roof.
    for (double side : {0.0, 180.0}) {
        Solid slope = quad({-1.25, 2.79, 0.0}, {2.5, 0, 0}, {0, -0.6, 0.85}).paint(kit.paints.tiles);
        slope.add(quad({-1.25, 2.13, 0.85}, {2.5, 0, 0}, {0, 0.6, -0.85}).paint(kit.paints.planks));
        slope.add(quad({-1.25, 2.19, 0.85}, {2.5, 0, 0}, {0, -0.06, 0}).paint(kit.paints.timber));
        for (double end : {-1.25, 1.25}) {
            const glm::dvec3 run(0, end < 0 ? -0.6 : 0.6, end < 0 ? 0.85 : -0.85);
            slope.add(quad({end, end < 0 ? 2.79 : 2.19, end < 0 ? 0.0 : 0.85}, run, {0, -0.06, 0})
                          .paint(kit.paints.timber));
        }
        solid.add(slope.turnY(side));
    }
    kit.builder.add("Well", solid, at);
}

void addFountain(TownKit& kit, const glm::dvec3& at) {
    Solid solid =
        lathe({{0.0, 1.93},    {0.061, 1.91},  {0.083, 1.83},  {0.057, 1.75},  {0.071, 1.59}, {0.21, 1.553},
               {0.47, 1.607},  {0.69, 1.711},  {0.733, 1.703}, {0.721, 1.661}, {0.53, 1.523}, {0.29, 1.441},
               {0.137, 1.37},  {0.103, 1.27},  {0.117, 1.09},  {0.177, 0.87},  {0.197, 0.73}, {0.147, 0.59},
               {0.241, 0.491}, {0.267, 0.417}, {0.27, 0.3}},
              40)
            .paint(kit.paints.stone);
    solid.add(lathe({{0.27, 0.33}, {1.43, 0.33}}, 40).paint(kit.paints.water));
    solid.add(lathe({{1.43, 0.33},
                     {1.47, 0.56},
                     {1.5, 0.585},
                     {1.68, 0.585},
                     {1.73, 0.55},
                     {1.72, 0.5},
                     {1.62, 0.44},
                     {1.6, 0.23},
                     {1.69, 0.17},
                     {1.72, -0.05}},
                    40)
                  .paint(kit.paints.stone));
    kit.builder.add("Fountain", solid, at);
}

void addAwning(TownKit& kit, const std::string& name, const Frame& frame, double x, double width,
               double height) {
    const Solid canvas = sheet({10, 10}, {0, -0.012, -0.01}, [=](double s, double t) {
        const bool isFringe = t > 0.9;
        const double out = std::min(t / 0.9, 1.0);
        return glm::dvec3(x + width * s,
                          height - 0.5 * out - (isFringe ? 0.2 : 0.0) - 0.03 * std::sin(kPi * out),
                          0.02 + 1.1 * out);
    });
    kit.builder.add(name, frame.put(Solid(canvas).paint(kit.paints.stripes)));
}

void addBalcony(TownKit& kit, const std::string& name, const Frame& frame, double x, double height) {
    constexpr double kHalf = 0.95, kOut = 0.8;
    Solid solid = block({x - kHalf, height - 0.16, -0.02}, {x + kHalf, height, kOut}).paint(kit.paints.stone);
    for (double side : {-0.7, 0.7})
        solid.add(block({x + side - 0.09, height - 0.42, -0.02}, {x + side + 0.09, height - 0.15, 0.42})
                      .paint(kit.paints.stone));
    Solid iron;
    const auto bar = [&](const glm::dvec2& at) {
        iron.add(
            lathe({{0.009, 0.93}, {0.009, 0.44}, {0.021, 0.42}, {0.021, 0.38}, {0.009, 0.36}, {0.009, -0.01}},
                  6)
                .move({x + at.x, height, at.y}));
    };
    for (int i = 0; i <= 15; ++i)
        bar({-kHalf + 0.04 + (2.0 * kHalf - 0.08) * i / 15.0, kOut - 0.04});
    for (int i = 1; i < 6; ++i)
        for (double side : {-kHalf + 0.04, kHalf - 0.04})
            bar({side, (kOut - 0.04) * i / 6.0});
    iron.add(block({x - kHalf + 0.01, height + 0.92, kOut - 0.07},
                   {x + kHalf - 0.01, height + 0.955, kOut - 0.01}));
    for (double side : {-kHalf + 0.01, kHalf - 0.07})
        iron.add(block({x + side, height + 0.92, 0.0}, {x + side + 0.06, height + 0.955, kOut - 0.06}));
    kit.builder.add(name, frame.put(solid.add(iron.paint(kit.paints.iron))));
}

void addLaundry(TownKit& kit, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 way = to - from;
    const auto along = [&](double t) { return from + t * way - glm::dvec3(0, 0.35 * std::sin(kPi * t), 0); };
    Solid rope = grid({.columns = 5, .rows = 16, .closedS = true}, [&](double s, double t) {
        const double a = kTwoPi * s;
        return along(t) - glm::dvec3(0, 0.007 * std::sin(a), 0) +
               0.007 * std::cos(a) * glm::normalize(glm::cross(glm::dvec3(0, 1, 0), way));
    });
    kit.builder.add("Laundry line", rope.paint(kit.paints.timber));
    const double turn = std::abs(way.z) > std::abs(way.x) ? 90.0 : 0.0;
    for (int i = 0; i < 5; ++i) {
        const double drop = 0.7 + 0.3 * random(i, 1, 151), width = 0.6 + 0.35 * random(i, 2, 151);
        Solid sheet = hangingCloth(width, drop, 0.06).turnY(turn).paint(kit.paints.cloth[i % kCloths]);
        kit.builder.add("Laundry " + std::to_string(i + 1), sheet,
                        along(0.18 + 0.16 * i) - glm::dvec3(0, 0.008, 0));
    }
}

void addIvy(TownKit& kit, const std::string& name, const Frame& frame, double from, double to,
            double height) {
    Solid solid;
    const int columns = static_cast<int>(std::lround((to - from) / 0.8)),
              rows = static_cast<int>(std::lround(height / 0.8));
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            const auto a = static_cast<uint32_t>(i), b = static_cast<uint32_t>(j);
            if (random(a, b, 161) < 0.12 * j) continue; // sparser upwards
            const glm::dvec3 at(from + 0.8 * i + 0.3 * random(a, b, 162), 0.8 * j + 0.3 * random(a, b, 163),
                                0.03 + 0.05 * random(a, b, 164));
            solid.add(quad({-0.6, 0.6, 0}, {1.2, 0, 0}, {0, -1.2, 0})
                          .turnY(30.0 * random(a, b, 165) - 15.0)
                          .move(at + glm::dvec3(0.4, 0.5, 0.12)));
        }
    kit.builder.add(name, frame.put(solid.paint(kit.paints.ivy)));
}

} // namespace relume::generate
