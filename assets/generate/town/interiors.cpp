#include "assets/generate/town/interiors.h"

#include "assets/generate/shapes/furniture.h"
#include "assets/generate/shapes/paint_image.h"
#include "assets/generate/shapes/pixels.h"

namespace relume::generate {
namespace {

Solid table(const glm::dvec3& at, const glm::dvec3& size) {
    const glm::dvec3 h = size / 2.0;
    Solid solid = block(at + glm::dvec3(-h.x, size.y - 0.045, -h.z), at + glm::dvec3(h.x, size.y, h.z));
    for (double x : {-h.x + 0.07, h.x - 0.07})
        for (double z : {-h.z + 0.07, h.z - 0.07})
            solid.add(block(at + glm::dvec3(x - 0.035, -0.012, z - 0.035),
                            at + glm::dvec3(x + 0.035, size.y - 0.03, z + 0.035)));
    return solid;
}

// Makes a chair whose back is at -Z.
Solid chair() {
    Solid solid = table({0, 0, 0}, {0.42, 0.46, 0.42});
    for (double x : {-0.175, 0.175})
        solid.add(block({x - 0.02, 0.44, -0.205}, {x + 0.02, 0.98, -0.165}));
    for (double y : {0.6, 0.74, 0.88})
        solid.add(block({-0.17, y, -0.197}, {0.17, y + 0.07, -0.173}));
    return solid;
}

Solid bottle(double scale) {
    return lathe({{0.0, 0.31 * scale},
                  {0.014, 0.31 * scale},
                  {0.014, 0.22 * scale},
                  {0.037, 0.17 * scale},
                  {0.041, 0.15 * scale},
                  {0.041, -0.004}},
                 12);
}

Solid mug() {
    return lathe({{0.0, 0.09}, {0.034, 0.09}, {0.036, 0.112}, {0.041, 0.113}, {0.043, -0.004}}, 12);
}

// Makes shelves against the wall at z = 0, open to +Z, from the floor up.
Solid shelves(double width, double depth, const std::vector<double>& boards) {
    const double top = boards.back();
    Solid solid = block({-width / 2, -0.012, 0.013}, {-width / 2 + 0.03, top + 0.031, depth});
    solid.add(block({width / 2 - 0.03, -0.012, 0.013}, {width / 2, top + 0.031, depth}));
    for (double y : boards)
        solid.add(block({-width / 2 + 0.02, y, 0.012}, {width / 2 - 0.02, y + 0.027, depth - 0.011}));
    return solid;
}

// Makes a lamp shade with a ring of cloth, hanging: the light is at the origin.
Solid shade(int cloth, int metal) {
    Solid solid =
        lathe({{0.082, 0.17}, {0.09, 0.17}, {0.27, -0.09}, {0.255, -0.09}, {0.082, 0.17}}, 24).paint(cloth);
    return solid.add(lathe({{0.008, 0.9}, {0.008, 0.15}}, 6).paint(metal));
}

} // namespace

void addShell(TownKit& kit, const InnerRoom& desc) {
    Room shell = room({desc.from, desc.floor, -kWall - desc.depth}, {desc.to, desc.ceiling, -kWall});
    std::vector<Opening> mirrored;
    for (const Opening& o : desc.openings)
        mirrored.push_back({{-o.high.x, o.low.y}, {-o.low.x, o.high.y}});
    Solid walls =
        Frame{{0, 0, -kWall}, 2}.put(wall({-desc.to, desc.floor}, {-desc.from, desc.ceiling}, mirrored));
    walls.add(shell.back).add(shell.left).add(shell.right);
    const auto put = [&](const char* part, Solid solid) {
        kit.builder.add(desc.name + " " + part, desc.frame.put(std::move(solid)));
    };
    put("walls", walls.paint(desc.wall));
    put("floor", mapped(shell.floor).paint(kit.paints.boards));
    put("ceiling", shell.ceiling.paint(kit.paints.inside));
    Solid skirting;
    const double back = -kWall - desc.depth;
    skirting.add(block({desc.from - 0.02, desc.floor - 0.02, back - 0.02},
                       {desc.to + 0.02, desc.floor + 0.13, back + 0.022}));
    skirting.add(block({desc.from - 0.02, desc.floor - 0.02, back + 0.01},
                       {desc.from + 0.022, desc.floor + 0.13, -kWall - 0.01}));
    skirting.add(block({desc.to - 0.022, desc.floor - 0.02, back + 0.01},
                       {desc.to + 0.02, desc.floor + 0.13, -kWall - 0.01}));
    put("skirting", skirting.paint(kit.paints.timber));
}

void furnishShop(TownKit& kit, const InnerRoom& desc) {
    const TownPaints& paints = kit.paints;
    const double middle = (desc.from + desc.to) / 2.0, back = -kWall - desc.depth;
    const std::vector<double> boards = {0.1, 0.55, 1.0, 1.45, 1.9};
    Solid things;
    for (int unit = 0; unit < 2; ++unit) {
        const double x = middle - 1.5 + 3.0 * unit;
        things.add(shelves(2.2, 0.34, boards).move({x, desc.floor, back}).paint(paints.planks));
        for (size_t k = 1; k + 1 < boards.size(); ++k)
            for (int i = 0; i < 9; ++i) {
                const auto a = static_cast<uint32_t>(i), b = static_cast<uint32_t>(3 * k + unit);
                const int color = (i + unit) % 3 == 0 ? paints.green
                                  : (i + k) % 3 == 0  ? paints.brown
                                                      : paints.terracotta;
                things.add(bottle(0.8 + 0.4 * random(a, b, 171))
                               .paint(color)
                               .move({x - 0.9 + 0.22 * i, desc.floor + boards[k] + 0.027, back + 0.17}));
            }
    }
    // The counter, with its panelled front towards the door.
    things.add(
        block({middle - 1.9, desc.floor - 0.012, back + 1.5}, {middle + 0.9, desc.floor + 0.94, back + 2.0})
            .paint(paints.green));
    things.add(block({middle - 1.96, desc.floor + 0.93, back + 1.44},
                     {middle + 0.96, desc.floor + 0.98, back + 2.07})
                   .paint(paints.planks));
    things.add(
        block({middle - 0.3, desc.floor + 0.97, back + 1.6}, {middle + 0.1, desc.floor + 1.2, back + 1.86})
            .paint(paints.brass));
    kit.builder.add(desc.name + " things", desc.frame.put(things));
    for (int i = 0; i < 3; ++i)
        kit.builder.place(kit.crate,
                          {desc.frame.point({desc.from + 0.6 + 0.1 * i, desc.floor + (i == 2 ? 0.57 : 0.0),
                                             back + 2.7 - (i == 1 ? 0.85 : 0.1 * i)}),
                           13.0 * i});
    kit.builder.add(
        desc.name + " shade",
        desc.frame.put(shade(paints.cloth[0], paints.iron).move({middle, desc.ceiling - 0.9, back + 2.4})));
}

void furnishTavern(TownKit& kit, const InnerRoom& desc) {
    const TownPaints& paints = kit.paints;
    const double back = -kWall - desc.depth;
    Solid things;
    int number = 0;
    for (double x : {desc.from + 1.6, desc.from + 6.6})
        for (double z : {-kWall - 1.3, -kWall - 3.4}) {
            const glm::dvec3 at(x, desc.floor, z);
            things.add(table(at, {1.5, 0.76, 0.8}).paint(paints.planks));
            for (int k = 0; k < 4; ++k)
                things.add(chair()
                               .turnY(k < 2 ? 0.0 : 180.0)
                               .turnY(11.0 * ((number + k) % 3 - 1))
                               .move(at + glm::dvec3(k % 2 ? 0.38 : -0.38, 0, k < 2 ? -0.62 : 0.62))
                               .paint(paints.brown));
            for (int k = 0; k < 3; ++k)
                things.add(mug()
                               .move(at + glm::dvec3(-0.45 + 0.4 * k, 0.76, k % 2 ? 0.2 : -0.17))
                               .paint(paints.brass));
            things.add(bottle(1.0).move(at + glm::dvec3(0.1 * number - 0.1, 0.76, 0.05)).paint(paints.green));
            ++number;
        }
    // The bar and the barrels behind it.
    const double middle = (desc.from + desc.to) / 2.0;
    things.add(
        block({middle - 1.4, desc.floor - 0.012, back + 1.3}, {middle + 1.4, desc.floor + 1.05, back + 1.8})
            .paint(paints.timber));
    things.add(
        block({middle - 1.5, desc.floor + 1.04, back + 1.22}, {middle + 1.5, desc.floor + 1.1, back + 1.87})
            .paint(paints.planks));
    for (int i = 0; i <= 6; ++i) {
        const double x = desc.from + 0.35 + (desc.to - desc.from - 0.7) * i / 6.0;
        things.add(block({x - 0.09, desc.ceiling - 0.19, back - 0.02},
                         {x + 0.09, desc.ceiling + 0.02, -kWall + 0.02})
                       .paint(paints.timber));
    }
    kit.builder.add(desc.name + " things", desc.frame.put(things));
    for (int i = 0; i < 5; ++i)
        kit.builder.place(kit.barrel,
                          {desc.frame.point({middle - 1.5 + 0.74 * i, desc.floor, back + 0.45}), 29.0 * i});
    for (double x : {-1.5, 1.9})
        kit.builder.add(
            desc.name + (x < 0 ? " shade left" : " shade right"),
            desc.frame.put(
                shade(paints.cloth[2], paints.iron).move({middle + x, desc.ceiling - 0.95, back + 2.8})));
}

void furnishStudy(TownKit& kit, const InnerRoom& desc) {
    const TownPaints& paints = kit.paints;
    const double middle = (desc.from + desc.to) / 2.0, back = -kWall - desc.depth;
    const std::vector<double> boards = {0.1, 0.52, 0.94, 1.36, 1.78, 2.2};
    Solid things;
    for (int unit = 0; unit < 2; ++unit) {
        const double x = desc.from + 1.0 + 1.72 * unit;
        things.add(shelves(1.66, 0.32, boards).move({x, desc.floor, back}).paint(paints.brown));
        for (size_t k = 0; k + 1 < boards.size(); ++k) {
            const double y = desc.floor + boards[k] + 0.02;
            // A row of books is a block whose front shows their backs.
            Solid books =
                block({x - 0.78, y, back + 0.013}, {x + 0.78 - 0.06 * double(k % 3), y + 0.3, back + 0.25});
            things.add(books.paint(paints.books));
        }
    }
    things.add(table({desc.to - 1.1, desc.floor, -kWall - 0.75}, {1.5, 0.75, 0.8}).paint(paints.brown));
    things.add(chair()
                   .turnY(180.0)
                   .turnY(18.0)
                   .move({desc.to - 1.2, desc.floor, -kWall - 1.45})
                   .paint(paints.brown));
    things.add(block({desc.to - 1.5, desc.floor + 0.745, -kWall - 0.9},
                     {desc.to - 1.25, desc.floor + 0.79, -kWall - 0.6})
                   .paint(paints.cloth[1]));
    things.add(lathe({{0.0, 0.36}, {0.012, 0.36}, {0.014, 0.05}, {0.085, 0.03}, {0.09, -0.004}}, 16)
                   .move({desc.to - 0.65, desc.floor + 0.75, -kWall - 0.55})
                   .paint(paints.brass));
    things.add(box({2.4, 0.025, 1.4}).move({middle - 0.2, desc.floor - 0.012, back + 2.2}).paint(paints.rug));
    kit.builder.add(desc.name + " things", desc.frame.put(things));
    Solid picture = framedPicture({0.96, 0.72}, kit.picture, paints.brass).turn(layOnWall());
    kit.builder.add(desc.name + " picture",
                    desc.frame.put(picture.move({desc.to - 1.3, desc.floor + 1.65, back})));
}

} // namespace relume::generate
