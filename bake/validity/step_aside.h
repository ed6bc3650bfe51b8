#pragma once

#include <array>
#include <span>
#include <vector>

#include "bake/validity/cover_search.h"
#include "bake/ranks/chunk_deal.h"
#include "bake/validity/inside_search.h"

namespace relume {

/// The cells of its texel that a patch tries for its own point, in this order.
constexpr uint32_t kMostCellsToTry = 2;
struct CellsToTry {
    std::array<uint32_t, kMostCellsToTry> cells;
    uint32_t count;
};
/// Returns those of these cells (PatchCover) that a patch tries: the nearest to its own point, then the
/// farthest from that. Others are beside these, and hardly ever lie outside where both lie inside.
CellsToTry cellsToTry(const shader::PatchCover& cover, uint32_t cells);

/// The cells on four sides of the middle by which a patch upon a surface is told: a knight's move away, so
/// that walls along the texel's sides or diagonals, and corners of two of them, have each cell on one side or
/// the other.
constexpr std::array<uint32_t, 4> kSideCells = {3, 5, 19, 21};

/// Lets patches that lie inside something step aside, where part of their texel lies outside: their own point
/// becomes the middle of a cell that it did not see and that lies outside (cellsToTry), and they send from
/// now on. So do those of `touching` (mayTouch(), ascending) that have cells inside something and others
/// outside (kSideCells), and see those inside or none of the others: their point lies upon the surface
/// between them, and becomes the middle of one of the others. Covers are those that have been searched, and
/// no patch has stepped aside yet. Patches that have are in PatchSet::aside, their covers are as their new
/// point sees them, and the device's patches and covers follow; senders of a tracer are the caller's. Each
/// rank seeks for its own chunks. What patches saw before from known points (ascending by patch) they see
/// from there again. `places` tells which cells lie inside something; where it is missing, its buffers are
/// given up before the covers are searched. Returns those that have stepped aside, ascending.
std::vector<uint32_t> stepAside(CoverSearcher& covers, Ranks& ranks, const ChunkDeal& dealt,
                                std::span<const uint32_t> touching, std::span<const OwnPoint> known = {},
                                PlaceSearcher* places = nullptr);

/// Takes all patches back to their own points; where they lie inside something, they send nothing. Returns
/// where they had stepped aside to, ascending by patch.
std::vector<OwnPoint> stepBack(PatchSet& patches);

/// Does so for the device's copies, too.
std::vector<OwnPoint> stepBack(const CoverSearch& search);

/// Returns where patches of a former bake had stepped aside to, as patches of another one: now[patch] is its
/// number there, or kNoPatch.
std::vector<OwnPoint> carryAside(std::span<const OwnPoint> former, std::span<const uint32_t> now);

/// Returns how many of those that have stepped aside lie inside something at home.
uint32_t asideFromInside(const PatchSet& patches);

/// Returns where patches have stepped aside to, ascending by patch.
std::vector<OwnPoint> pointsAside(const PatchSet& patches);

/// The patches that two lists of own points (ascending) differ in, ascending.
struct OtherPoints {
    std::vector<uint32_t> points;  // have another point or see something else, or are in one list alone
    std::vector<uint32_t> senders; // are in one list alone
};
OtherPoints otherPoints(std::span<const OwnPoint> before, std::span<const OwnPoint> now);

} // namespace relume
