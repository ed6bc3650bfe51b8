#include "assets/generate/town/kit.h"

#include <cmath>

namespace relume::generate {
namespace {

struct FittingDesc {
    const char* name;
    glm::dvec2 size;
    int columns, rows; // of panes
    bool glazed, hasSurround;
};
const FittingDesc kFittings[] = {
    {"Tall window", {1.04, 1.72}, 2, 3, false, true},  {"Small window", {0.76, 0.98}, 2, 2, false, true},
    {"Shop window", {2.2, 1.84}, 3, 2, false, false},  {"Door", {1.14, 2.3}, 1, 1, false, true},
    {"Glazed window", {1.04, 1.72}, 2, 3, true, true}, {"Glazed shop window", {2.2, 1.84}, 3, 2, true, false},
};
constexpr double kBlindDepth = 0.22;  // [m] of openings without a room
constexpr double kBar = 0.035;        // [m] half the width of a bar between panes
constexpr double kEdge = 0.062;       // [m] the width of a frame at its edge
constexpr double kFrameFront = -0.13; // [m]
constexpr double kFrameBack = -0.19;

// Returns the panes of a frame that fills an opening from (0, 0) to `size`.
std::vector<Opening> panesOf(const FittingDesc& desc) {
    const glm::dvec2 inner = desc.size - 2.0 * kEdge;
    const glm::dvec2 pane(inner.x / desc.columns, inner.y / desc.rows);
    std::vector<Opening> panes;
    for (int j = 0; j < desc.rows; ++j)
        for (int i = 0; i < desc.columns; ++i) {
            const glm::dvec2 low = kEdge + pane * glm::dvec2(i, j);
            panes.push_back(
                {low + glm::dvec2(i > 0 ? kBar : 0.0, j > 0 ? kBar : 0.0),
                 low + pane - glm::dvec2(i + 1 < desc.columns ? kBar : 0.0, j + 1 < desc.rows ? kBar : 0.0)});
        }
    return panes;
}

Solid windowFrame(const FittingDesc& desc) {
    const std::vector<Opening> panes = panesOf(desc);
    Solid solid = wall({0, 0}, desc.size, panes).move({0, 0, kFrameFront});
    for (const Opening& pane : panes)
        solid.add(reveal(pane, kFrameFront, kFrameBack));
    if (desc.glazed) solid.add(Frame{{desc.size.x, 0.0, kFrameBack}, 2}.put(wall({0, 0}, desc.size, panes)));
    return solid;
}

// Makes the stone band around an opening, and the sill below it.
Solid surround(const FittingDesc& desc, bool hasSill) {
    const glm::dvec2 h = desc.size / 2.0;
    Solid band = moulding(h, {{-0.004, -0.17},
                              {-0.004, 0.042},
                              {0.034, 0.057},
                              {0.063, 0.045},
                              {0.121, 0.045},
                              {0.135, 0.027},
                              {0.135, -0.01}});
    band.turn(layOnWall()).move({h.x, h.y, 0.0});
    if (hasSill)
        band.add(strip(-0.19, desc.size.x + 0.19,
                       {{-0.12, 0.021},
                        {0.157, 0.009},
                        {0.157, -0.049},
                        {0.113, -0.071},
                        {0.105, -0.117},
                        {0.0, -0.151}}));
    return band.add(strip(-0.17, desc.size.x + 0.17,
                          {{0.0, desc.size.y + 0.263},
                           {0.147, desc.size.y + 0.239},
                           {0.147, desc.size.y + 0.197},
                           {0.071, desc.size.y + 0.143},
                           {0.0, desc.size.y + 0.139}}));
}

Solid doorLeaf(const FittingDesc& desc) {
    const glm::dvec2 size = desc.size;
    const std::vector<Opening> panels = {{{0.14, 0.16}, {size.x / 2 - 0.05, 0.86}},
                                         {{size.x / 2 + 0.05, 0.16}, {size.x - 0.14, 0.86}},
                                         {{0.14, 1.0}, {size.x / 2 - 0.05, 2.14}},
                                         {{size.x / 2 + 0.05, 1.0}, {size.x - 0.14, 2.14}}};
    Solid leaf = wall({0, 0}, size, panels).move({0, 0, -0.16});
    for (const Opening& panel : panels) {
        const glm::dvec2 h = (panel.high - panel.low) / 2.0, middle = panel.low + h;
        // A raised field: its ring goes from the hole's edge back, and forward to the middle.
        Solid field = moulding(h, {{-0.094, 0.012}, {-0.028, -0.021}, {0.0, 0.0}});
        leaf.add(field.turn(layOnWall()).move({middle.x, middle.y, -0.16}));
        leaf.add(wall(panel.low + 0.094, panel.high - 0.094).move({0, 0, -0.148}));
    }
    return leaf;
}

Solid makeFitting(const TownPaints& paints, Fitting fitting) {
    const FittingDesc& desc = kFittings[static_cast<int>(fitting)];
    Solid solid;
    if (fitting == Fitting::Door) {
        solid = doorLeaf(desc).paint(paints.brown);
        solid.add(sphere(0.041, 3).move({0.97, 1.06, -0.117}).paint(paints.brass));
        solid.add(block({-0.13, -0.3, -0.02}, {desc.size.x + 0.13, 0.017, 0.31}).paint(paints.stone));
    } else {
        const bool isShop = fitting == Fitting::Shop || fitting == Fitting::GlazedShop;
        solid = windowFrame(desc).paint(isShop ? paints.green : paints.white);
        const double z = desc.glazed ? (kFrameFront + kFrameBack) / 2.0 : kFrameBack;
        solid.add(
            wall({0, 0}, desc.size).move({0, 0, z}).paint(desc.glazed ? paints.glass : paints.darkGlass));
        if (isShop) {
            solid.add(
                strip(-0.1, desc.size.x + 0.1, {{-0.12, 0.02}, {0.14, 0.01}, {0.14, -0.06}, {0.0, -0.11}})
                    .paint(paints.green));
            solid.add(strip(-0.1, desc.size.x + 0.1,
                            {{0.0, desc.size.y + 0.54},
                             {0.11, desc.size.y + 0.51},
                             {0.07, desc.size.y + 0.45},
                             {0.05, desc.size.y + 0.11},
                             {0.08, desc.size.y + 0.05},
                             {0.0, desc.size.y + 0.02}})
                          .paint(paints.green));
        }
    }
    if (desc.hasSurround) solid.add(surround(desc, fitting != Fitting::Door).paint(paints.stone));
    return solid;
}

// Makes a leaf of louvres in a frame, its hinge at x = 0.
Solid shutterLeaf(const glm::dvec2& size) {
    const Opening field{{0.055, 0.07}, size - glm::dvec2(0.055, 0.07)};
    constexpr int kSlats = 12;
    Solid leaf = wall({0, 0}, size, {field}).move({0, 0, 0.034});
    const double height = field.high.y - field.low.y;
    // The slats are one folded sheet: each leans out and the next begins behind it.
    leaf.add(grid({.columns = 1, .rows = 2 * kSlats}, [&](double s, double t) {
        const long row = std::lround(t * 2 * kSlats);
        const double y =
            field.high.y - height * (double(row / 2) / kSlats) - (row % 2 ? 0.93 * height / kSlats : 0.0);
        return glm::dvec3(field.low.x + s * (field.high.x - field.low.x), y, row % 2 ? 0.033 : 0.009);
    }));
    leaf.add(reveal(field, 0.034, -0.01));
    // From back to front the sides of an opening face outwards; these end inside the wall.
    return leaf.add(reveal({{0, 0}, size}, -0.03, 0.034));
}

Solid balusterSolid() {
    return lathe({{0.0, 0.78},
                  {0.079, 0.78},
                  {0.081, 0.741},
                  {0.056, 0.717},
                  {0.049, 0.701},
                  {0.047, 0.617},
                  {0.061, 0.593},
                  {0.049, 0.571},
                  {0.044, 0.521},
                  {0.057, 0.419},
                  {0.083, 0.311},
                  {0.091, 0.247},
                  {0.081, 0.181},
                  {0.053, 0.131},
                  {0.047, 0.107},
                  {0.071, 0.087},
                  {0.083, 0.061},
                  {0.085, -0.03}},
                 16);
}

// Makes two rows of pantiles on the slope, from its foot at the origin upwards to -Z.
Solid tileRowSolid() {
    constexpr int kTiles = 6, kPerTile = 4, kRows = 2;
    const double along = std::cos(glm::radians(kTilePitch)), up = std::sin(glm::radians(kTilePitch));
    return grid({.columns = kTiles * kPerTile, .rows = 2 * kRows}, [&](double s, double t) {
        const long step = 2 * kRows - std::lround(t * 2 * kRows); // from the foot
        const double slope = kTileRow.y * double(step / 2) / kRows + (step % 2 ? 0.011 : 0.0);
        // The foot of a row lies on the head of the one below it.
        // The first foot begins below the roof, so that nobody looks under it.
        const double lift = step == 0 ? -0.06 : step % 2 ? 0.082 : 0.042;
        const double wave = 0.026 * std::sin(kTwoPi * s * kTiles);
        const double out = lift + wave;
        return glm::dvec3(kTileRow.x * s, slope * up + out * along, -slope * along + out * up);
    });
}

// Makes the end of a rafter below the eaves: it leaves the wall at the origin and slopes down.
Solid rafterSolid() {
    const double c = std::cos(glm::radians(kTilePitch)), s = std::sin(glm::radians(kTilePitch));
    return block({-0.05, -0.14, -0.1}, {0.05, 0.02, 0.43}).turn(glm::dmat3({1, 0, 0}, {0, c, s}, {0, -s, c}));
}

Solid columnSolid() {
    Solid solid = lathe({{0.0, 2.402},   {0.245, 2.402}, {0.247, 2.337}, {0.223, 2.317}, {0.235, 2.273},
                         {0.207, 2.231}, {0.181, 2.207}, {0.177, 2.131}, {0.196, 2.111}, {0.198, 2.091},
                         {0.179, 2.071}, {0.181, 1.81},  {0.187, 1.43},  {0.193, 1.02},  {0.197, 0.63},
                         {0.198, 0.337}, {0.219, 0.313}, {0.226, 0.281}, {0.214, 0.249}, {0.229, 0.219},
                         {0.256, 0.187}, {0.261, 0.151}, {0.249, 0.129}, {0.283, 0.127}, {0.285, -0.05}},
                        24);
    solid.add(block({-0.29, 2.39, -0.27}, {0.29, 2.52, 0.27}));
    return solid;
}

} // namespace

glm::dvec2 sizeOf(Fitting fitting) {
    return kFittings[static_cast<int>(fitting)].size;
}

double depthOf(Fitting fitting) {
    return kFittings[static_cast<int>(fitting)].glazed ? kWall : kBlindDepth;
}

void makeFittings(TownKit& kit) {
    for (int i = 0; i < static_cast<int>(Fitting::Count); ++i)
        kit.fitting[i] =
            kit.builder.share(kFittings[i].name, makeFitting(kit.paints, static_cast<Fitting>(i)));
    const glm::dvec2 leaf(0.5, 1.68);
    kit.shutter[0] =
        kit.builder.share("Green shutter", shutterLeaf(leaf).paint(kit.paints.green), Batched::Yes);
    kit.shutter[1] =
        kit.builder.share("Blue shutter", shutterLeaf(leaf).paint(kit.paints.blue), Batched::Yes);
    kit.baluster = kit.builder.share("Baluster", balusterSolid().paint(kit.paints.stone), Batched::Yes);
    kit.rafter = kit.builder.share("Rafter", rafterSolid().paint(kit.paints.timber), Batched::Yes);
    kit.tileRow = kit.builder.share("Pantiles", tileRowSolid().paint(kit.paints.tileRows), Batched::Yes);
    kit.column = kit.builder.share("Column", columnSolid().paint(kit.paints.stone));
}

void fit(TownKit& kit, Fitting fitting, const Frame& frame, const glm::dvec2& at) {
    kit.builder.place(kit.fitting[static_cast<int>(fitting)],
                      {.position = frame.point({at.x, at.y, 0.0}), .turn = frame.turn()});
}

void addShutters(TownKit& kit, Fitting fitting, const Frame& frame, const glm::dvec2& at, int color) {
    const glm::dvec2 size = sizeOf(fitting);
    const glm::dvec3 scale(1.0, size.y / 1.72, 1.0);
    const int shutter = kit.shutter[color];
    // They lean against the wall beside the surround.
    kit.builder.place(shutter, {frame.point({at.x - 0.68, at.y + 0.02, 0.012}), frame.turn(), scale});
    kit.builder.place(shutter,
                      {frame.point({at.x + size.x + 0.18, at.y + 0.02, 0.012}), frame.turn(), scale});
}

} // namespace relume::generate
