#include "bake/validity/step_aside.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "assets/base/portions.h"

namespace relume {
namespace {

using shader::kCoverCells;

constexpr uint8_t kStays = 0xff;  // in place of a cell
constexpr size_t kPortion = 1024; // seekers that a thread takes at a time
// All patches are uploaded where more than one in so many is written: that is faster than many small regions.
constexpr size_t kUploadsAll = 64;

// A patch that seeks another own point, and the cells that it tries.
struct Seeker {
    uint32_t patch;
    CellsToTry cells;
};

bool isSilent(const shader::Patch& patch) {
    return patch.area > 0.0f && (patch.flags & shader::kPatchSends) == 0;
}

// Returns the patches of these chunks that may step aside. Cells that a patch inside something sees lie in
// it, too.
std::vector<Seeker> seekersIn(const CoverSearch& search, std::span<const ChunkRange> chunks) {
    const PatchSet& patches = search.patches;
    const auto hidden = [&](size_t i) {
        return patches.coverCells[i] & ~patches.covers[i].cells & kCoverCells;
    };
    WorkerPool& pool = search.device.workers();
    std::vector<Seeker> seekers;
    for (const ChunkRange& range : chunks) {
        const size_t first = size_t{range.first} * shader::kChunk;
        const size_t end = std::min<size_t>(patches.count, first + size_t{range.count} * shader::kChunk);
        if (first >= end) continue;
        const std::vector<uint32_t> found = numbersWhere(pool, end - first, [&](size_t i) {
            return isSilent(patches.scene.patches[first + i]) && hidden(first + i) != 0;
        });
        const size_t before = seekers.size();
        seekers.resize(before + found.size());
        runPortions(pool, found.size(), kPortion, [&](size_t from, size_t to) {
            for (size_t k = from; k < to; ++k) {
                const size_t i = first + found[k];
                seekers[before + k] = {static_cast<uint32_t>(i), cellsToTry(patches.covers[i], hidden(i))};
            }
        });
    }
    return seekers;
}

// Writes the cell that each of these patches steps to. A GPU asks for all of a patch's cells at once, a CPU
// for the next one where the one before lies inside.
void seekCells(const CoverSearch& search, PlaceSearcher& searcher, std::vector<Seeker> seekers,
               std::vector<uint8_t>& cells) {
    const PatchSet& patches = search.patches;
    const uint32_t atOnce = search.tracer.records() ? kMostCellsToTry : 1;
    for (uint32_t first = 0; !seekers.empty(); first += atOnce) {
        std::vector<shader::Patch> places;
        for (const Seeker& seeker : seekers)
            for (uint32_t k = first; k < std::min(first + atOnce, seeker.cells.count); ++k) {
                places.push_back(patches.scene.patches[seeker.patch]);
                places.back().position +=
                    shader::coverWay(patches.covers[seeker.patch], shader::cellPlace(seeker.cells.cells[k]));
            }
        const std::vector<PlaceKind> kinds = searcher.kindsOf(places, search.onBatch);
        std::vector<Seeker> left;
        size_t place = 0;
        for (const Seeker& seeker : seekers) {
            const uint32_t end = std::min(first + atOnce, seeker.cells.count);
            bool found = false;
            for (uint32_t k = first; k < end; ++k)
                if (kinds[place++] != PlaceKind::Inside && !std::exchange(found, true))
                    cells[seeker.patch] = static_cast<uint8_t>(seeker.cells.cells[k]);
            if (!found && end < seeker.cells.count) left.push_back(seeker);
        }
        seekers = std::move(left);
    }
}

// Writes the cell that each of these patches steps to that lie upon a surface.
void leaveSurfaces(const CoverSearch& search, PlaceSearcher& searcher, std::span<const uint32_t> touching,
                   std::vector<uint8_t>& cells) {
    constexpr size_t kAtOnce = size_t{1} << 16; // for their places take four times a patch's memory
    if (touching.size() > kAtOnce) {
        leaveSurfaces(search, searcher, touching.first(kAtOnce), cells);
        return leaveSurfaces(search, searcher, touching.subspan(kAtOnce), cells);
    }
    const PatchSet& patches = search.patches;
    struct Side {
        uint32_t patch, cell;
        bool seen;
    };
    std::vector<Side> sides;
    std::vector<shader::Patch> places;
    for (const uint32_t patch : touching)
        for (const uint32_t cell : kSideCells) {
            if ((patches.coverCells[patch] >> cell & 1u) == 0) continue;
            sides.push_back({patch, cell, (patches.covers[patch].cells >> cell & 1u) != 0});
            places.push_back(patches.scene.patches[patch]);
            places.back().position += shader::coverWay(patches.covers[patch], shader::cellPlace(cell));
        }
    if (places.empty()) return;
    const std::vector<PlaceKind> kinds = searcher.kindsOf(places, search.onBatch);
    for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
        uint32_t outside = kStays; // a cell that lies wholly so
        bool hidden = false, seesInside = false, seesOutside = false;
        for (; end < sides.size() && sides[end].patch == sides[begin].patch; ++end) {
            const bool inside = kinds[end] == PlaceKind::Inside, clear = kinds[end] == PlaceKind::Outside;
            hidden = hidden || inside;
            seesInside = seesInside || (inside && sides[end].seen);
            seesOutside = seesOutside || (clear && sides[end].seen);
            if (clear && outside == kStays) outside = sides[end].cell;
        }
        // A point that sees what lies outside, and nothing else, lies there itself.
        if (hidden && (seesInside || !seesOutside)) cells[sides[begin].patch] = static_cast<uint8_t>(outside);
    }
}

// Returns PatchCover::place of a cell's middle.
uint32_t placeOf(uint32_t cell) {
    const glm::uvec2 place(shader::cellPlace(cell) * static_cast<float>(shader::kCoverPlaces) + 0.5f);
    return place.x | place.y << 16;
}

OwnPoint pointOf(const PatchSet& patches, uint32_t patch) {
    const shader::PatchCover& cover = patches.covers[patch];
    const shader::Patch& own = patches.scene.patches[patch];
    return {patch, own.position, cover.place, cover.cells, (own.flags & shader::kPatchSends) != 0};
}

void setPoint(PatchSet& patches, const OwnPoint& point) {
    patches.scene.patches[point.patch].position = point.position;
    shader::PatchCover& cover = patches.covers[point.patch];
    cover.place = point.place;
    cover.cells = point.cells;
}

template<typename T>
void uploadSome(const vk::Device& device, const vk::Buffer& buffer, const std::vector<T>& values,
                const std::vector<uint32_t>& which) {
    if (which.size() > values.size() / kUploadsAll)
        return vk::upload(device, buffer, values.data(), values.size() * sizeof(T));
    vk::uploadElements(device, buffer, values, which);
}

void upload(const CoverSearch& search, const std::vector<uint32_t>& patches) {
    uploadSome(search.device, *search.devicePatches, search.patches.scene.patches, patches);
    uploadSome(search.device, *search.deviceCovers, search.patches.covers, patches);
}

} // namespace

CellsToTry cellsToTry(const shader::PatchCover& cover, uint32_t cells) {
    const auto wayTo = [&](uint32_t cell) { return shader::coverWay(cover, shader::cellPlace(cell)); };
    // Returns the cell whose square distance from there [m^2], times a sign, is the least.
    const auto least = [&](const glm::vec3& from, float sign) {
        std::pair<float, uint32_t> found{std::numeric_limits<float>::max(), 0};
        for (uint32_t rest = cells & kCoverCells; rest != 0; rest &= rest - 1) {
            const auto cell = static_cast<uint32_t>(std::countr_zero(rest));
            const glm::vec3 way = wayTo(cell) - from;
            found = std::min(found, {sign * glm::dot(way, way), cell});
        }
        return found.second;
    };
    if ((cells & kCoverCells) == 0) return {};
    const uint32_t nearest = least(glm::vec3(0.0f), 1.0f), farthest = least(wayTo(nearest), -1.0f);
    return {{nearest, farthest}, farthest == nearest ? 1u : 2u};
}

std::vector<uint32_t> stepAside(CoverSearcher& covers, Ranks& ranks, const ChunkDeal& dealt,
                                std::span<const uint32_t> touching, std::span<const OwnPoint> known,
                                PlaceSearcher* places) {
    const CoverSearch& search = covers.on();
    PatchSet& patches = search.patches;
    ASSERT(patches.aside.empty());
    const std::span<const ChunkRange> own = dealt.runsOf(ranks.rank());
    std::vector<uint8_t> cells(patches.scene.patches.size(), kStays);
    {
        PlaceSearcher once(search.device, search.tracer);
        PlaceSearcher& searcher = places ? *places : once;
        seekCells(search, searcher, seekersIn(search, own), cells);
        leaveSurfaces(search, searcher, patchesIn(own, touching), cells);
    }
    shareChunks(ranks, dealt, cells);
    std::vector<uint32_t> aside, looking;
    auto before = known.begin();
    for (uint32_t i = 0; i < patches.count; ++i) {
        if (cells[i] == kStays) continue;
        patches.aside.push_back(pointOf(patches, i));
        shader::Patch& patch = patches.scene.patches[i];
        shader::PatchCover& cover = patches.covers[i];
        patch.position += shader::coverWay(cover, shader::cellPlace(cells[i]));
        patch.flags |= shader::kPatchSends;
        cover.place = placeOf(cells[i]);
        aside.push_back(i);
        while (before != known.end() && before->patch < i)
            ++before;
        if (before != known.end() && before->patch == i && before->position == patch.position)
            cover.cells = before->cells;
        else
            looking.push_back(i);
    }
    if (!looking.empty()) {
        upload(search, looking);
        covers.search(patchesIn(own, looking));
        shareCells(ranks, dealt, looking, patches, search.device.workers());
    }
    upload(search, aside);
    return aside;
}

std::vector<OwnPoint> stepBack(PatchSet& patches) {
    std::vector<OwnPoint> aside = pointsAside(patches);
    for (const OwnPoint& home : std::exchange(patches.aside, {})) {
        setPoint(patches, home);
        if (!home.sends) patches.scene.patches[home.patch].flags &= ~shader::kPatchSends;
    }
    return aside;
}

std::vector<OwnPoint> stepBack(const CoverSearch& search) {
    std::vector<OwnPoint> aside = stepBack(search.patches);
    std::vector<uint32_t> back;
    for (const OwnPoint& point : aside)
        back.push_back(point.patch);
    if (!back.empty()) upload(search, back);
    return aside;
}

std::vector<OwnPoint> carryAside(std::span<const OwnPoint> former, std::span<const uint32_t> now) {
    std::vector<OwnPoint> aside;
    for (OwnPoint point : former) {
        point.patch = now[point.patch];
        if (point.patch != shader::kNoPatch) aside.push_back(point);
    }
    std::sort(aside.begin(), aside.end(),
              [](const OwnPoint& a, const OwnPoint& b) { return a.patch < b.patch; });
    return aside;
}

uint32_t asideFromInside(const PatchSet& patches) {
    return static_cast<uint32_t>(std::count_if(patches.aside.begin(), patches.aside.end(),
                                               [](const OwnPoint& home) { return !home.sends; }));
}

std::vector<OwnPoint> pointsAside(const PatchSet& patches) {
    std::vector<OwnPoint> points;
    for (const OwnPoint& home : patches.aside)
        points.push_back(pointOf(patches, home.patch));
    return points;
}

OtherPoints otherPoints(std::span<const OwnPoint> before, std::span<const OwnPoint> now) {
    OtherPoints others;
    const auto note = [&](uint32_t patch, bool sender) {
        others.points.push_back(patch);
        if (sender) others.senders.push_back(patch);
    };
    auto a = before.begin(), b = now.begin();
    while (a != before.end() || b != now.end()) {
        if (b == now.end() || (a != before.end() && a->patch < b->patch)) {
            note((a++)->patch, true);
        } else if (a == before.end() || b->patch < a->patch) {
            note((b++)->patch, true);
        } else {
            if (*a != *b) note(a->patch, false);
            ++a;
            ++b;
        }
    }
    return others;
}

} // namespace relume
