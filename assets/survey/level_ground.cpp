#include "assets/survey/level_ground.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

constexpr float kLeastEdge = 20.0f, kMostEdge = 3000.0f, kMostHeight = 600.0f; // of a town [m]
constexpr float kLeastCell = 0.75f;    // [m], some steps of which lie across an alley
constexpr float kMostCells = 160.0f;   // along the longest edge
constexpr float kHeadRoom = 2.2f;      // [m]
constexpr float kLevel = 0.8f;         // the cosine of the steepest ground's slope
constexpr float kStep = 0.35f;         // [m], two stairs at once
constexpr float kSlope = 0.6f;         // of the way from one cell to the next: stairs and ramps
constexpr int kMostFloors = 8;         // below each other, that are looked for
constexpr float kSkip = 0.05f;         // [m], below what was met: the same surface is not met again
constexpr float kLeastGround = 200.0f; // [m^2], of a street
constexpr float kTurned = 0.1f;        // share of backs seen from above from which on sides say nothing

struct Floor {
    float y = 0.0f;
    bool open = false;  // the sky is straight above
    uint32_t piece = 0; // the first floor known of the piece that it belongs to
};

/// Floors of a grid of columns, those of a column from the top down.
struct Grid {
    glm::ivec2 size{0};
    float cell = 0.0f;           // [m]
    std::vector<uint32_t> first; // floor of each column, and the number of floors
    std::vector<Floor> floors;
};

void lookDown(const LevelRays& rays, const glm::vec3& top, Grid& grid, glm::ivec2& sides) {
    glm::vec3 from = top;
    float ceiling = std::numeric_limits<float>::infinity();
    for (int i = 0; i < kMostFloors; ++i) {
        const LevelHit hit = rays.trace(from, {0.0f, -1.0f, 0.0f});
        if (std::isinf(hit.distance)) return;
        const float y = from.y - hit.distance;
        if (i == 0) ++(hit.front ? sides.x : sides.y);
        if (std::abs(hit.normal.y) >= kLevel && ceiling - y >= kHeadRoom)
            grid.floors.push_back({y, i == 0, static_cast<uint32_t>(grid.floors.size())});
        ceiling = y;
        from.y = y - kSkip;
    }
}

uint32_t pieceOf(std::vector<Floor>& floors, uint32_t floor) {
    while (floors[floor].piece != floor) {
        floors[floor].piece = floors[floors[floor].piece].piece; // halves the way
        floor = floors[floor].piece;
    }
    return floor;
}

// Joins floors of two columns side by side between which one can walk.
void join(Grid& grid, size_t column, size_t other) {
    for (uint32_t a = grid.first[column]; a < grid.first[column + 1]; ++a)
        for (uint32_t b = grid.first[other]; b < grid.first[other + 1]; ++b)
            if (std::abs(grid.floors[a].y - grid.floors[b].y) <= kStep + kSlope * grid.cell)
                grid.floors[pieceOf(grid.floors, a)].piece = pieceOf(grid.floors, b);
}

} // namespace

LevelGround findGround(const LevelRays& rays, const glm::vec3& low, const glm::vec3& high) {
    const glm::vec3 size = high - low;
    const float longest = std::max(size.x, size.z);
    if (!(longest >= kLeastEdge && longest <= kMostEdge && size.y <= kMostHeight)) return {};
    Grid grid;
    grid.cell = std::max(kLeastCell, longest / kMostCells);
    grid.size = glm::max(glm::ivec2(glm::vec2(size.x, size.z) / grid.cell), glm::ivec2(1));
    const auto columns = static_cast<size_t>(grid.size.x) * static_cast<size_t>(grid.size.y);
    const auto width = static_cast<size_t>(grid.size.x);
    const auto middle = [&](size_t column) {
        return glm::vec2(low.x, low.z) +
               (glm::vec2(static_cast<float>(column % width), static_cast<float>(column / width)) + 0.5f) *
                   grid.cell;
    };
    glm::ivec2 sides(0);
    for (size_t column = 0; column < columns; ++column) {
        grid.first.push_back(static_cast<uint32_t>(grid.floors.size()));
        const glm::vec2 at = middle(column);
        lookDown(rays, {at.x, high.y + 1.0f, at.y}, grid, sides);
    }
    grid.first.push_back(static_cast<uint32_t>(grid.floors.size()));
    for (size_t column = 0; column < columns; ++column) {
        if (column % width + 1 < width) join(grid, column, column + 1);
        if (column + width < columns) join(grid, column, column + width);
    }
    std::vector<uint32_t> open(grid.floors.size(), 0);
    for (uint32_t i = 0; i < grid.floors.size(); ++i)
        if (grid.floors[i].open) ++open[pieceOf(grid.floors, i)];
    LevelGround ground;
    ground.sided = static_cast<float>(sides.y) <= kTurned * static_cast<float>(sides.x + sides.y);
    const auto large = [&](uint32_t floor) {
        return static_cast<float>(open[pieceOf(grid.floors, floor)]) * grid.cell * grid.cell >= kLeastGround;
    };
    for (size_t column = 0; column < columns; ++column)
        for (uint32_t i = grid.first[column]; i < grid.first[column + 1]; ++i)
            if (grid.floors[i].open && large(i)) {
                const glm::vec2 at = middle(column);
                ground.places.push_back({at.x, grid.floors[i].y, at.y});
            }
    return ground;
}

} // namespace relume
