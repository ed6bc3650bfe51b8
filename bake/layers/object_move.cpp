#include "bake/layers/object_move.h"

#include "assets/base/error.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kChunk;

// There are so many boxes at most; beyond, one goes around all of them. Each is a test per ray.
constexpr size_t kMostPlaceBoxes = 8;
// A thread looks at so many chunks in one go.
constexpr uint32_t kTaskChunks = 128;

// Tells whether a segment from within a to within b may meet the box: points between are within boxes that go
// from a to b evenly, and along each axis such a box meets the other one for an interval of the way.
bool shaftMeets(const shader::TraceBox& a, const shader::TraceBox& b, const shader::TraceBox& box) {
    float from = 0.0f, to = 1.0f;
    const auto atMost = [&](float start, float end, float limit) { // start + t (end - start) <= limit
        const float slope = end - start, room = limit - start;
        if (slope > 0.0f)
            to = std::min(to, room / slope);
        else if (slope < 0.0f)
            from = std::max(from, room / slope);
        else if (room < 0.0f)
            to = -1.0f;
    };
    for (int axis = 0; axis < 3; ++axis) {
        atMost(a.lo[axis], b.lo[axis], box.hi[axis]);
        atMost(-a.hi[axis], -b.hi[axis], -box.lo[axis]);
    }
    return from <= to;
}

shader::TraceBox endOf(const shader::TraceBox& start, const LightPlace& light) {
    if (light.kind == LightPlace::Kind::Box) return {light.lo, light.hi};
    return {start.lo + light.lo, start.hi + light.hi};
}

} // namespace

void ObjectMove::add(const ObjectMove& later) {
    ASSERT(changed.empty() || changed.size() == later.changed.size());
    boxes.insert(boxes.end(), later.boxes.begin(), later.boxes.end());
    if (boxes.size() > kMostPlaceBoxes) {
        shader::TraceBox all = boxes.front();
        for (const shader::TraceBox& box : boxes)
            all = {glm::min(all.lo, box.lo), glm::max(all.hi, box.hi)};
        boxes = {all};
    }
    const auto addBits = [](std::vector<glm::uvec2>& all, const std::vector<glm::uvec2>& more) {
        all.resize(std::max(all.size(), more.size()), glm::uvec2(0));
        for (size_t i = 0; i < more.size(); ++i)
            all[i] |= more[i];
    };
    addBits(changed, later.changed);
    addBits(ends, later.ends);
    instances.insert(instances.end(), later.instances.begin(), later.instances.end());
    texels = texels || later.texels;
}

std::vector<uint8_t> chunksReached(WorkerPool& pool, const PatchSet& patches, const LightPlace& light,
                                   const ObjectMove& move) {
    const auto meets = [&](const shader::TraceBox& start, const shader::TraceBox& box) {
        return light.kind == LightPlace::Kind::Everywhere || shaftMeets(start, endOf(start, light), box);
    };
    const shader::Patch* const all = patches.scene.patches.data();
    const auto patchReached = [&](const shader::Patch& p, const shader::TraceBox& box) {
        if ((p.flags & shader::kPatchSends) == 0 || !shader::boxAbove(p.position, p.normal, box))
            return false;
        const glm::vec3 origin = p.position + p.offset * p.normal;
        const shader::PatchCover* cover =
            patches.covers.empty() ? nullptr : &patches.covers[size_t(&p - all)];
        const glm::vec3 reach =
            cover && cover->cells != 0 ? glm::abs(cover->du) + glm::abs(cover->dv) : glm::vec3(0.0f);
        return meets({origin - reach, origin + reach}, box);
    };
    const auto chunkReached = [&](uint32_t chunk) {
        if (move.changes(chunk)) return true;
        const auto first = patches.scene.patches.begin() + size_t{chunk} * kChunk;
        const shader::ChunkBounds& bounds = patches.bounds[chunk];
        const float starts = patches.reach.empty() ? 0.0f : patches.reach[chunk];
        const glm::vec3 grown(0.01f * bounds.size + starts); // more than a patch's offset
        return std::any_of(move.boxes.begin(), move.boxes.end(), [&](const shader::TraceBox& box) {
            return meets({bounds.lo - grown, bounds.hi + grown}, box) &&
                   std::any_of(first, first + kChunk,
                               [&](const shader::Patch& p) { return patchReached(p, box); });
        });
    };
    std::vector<uint8_t> reached(patches.chunkCount(), 0);
    const uint32_t count = patches.chunkCount();
    pool.run((count + kTaskChunks - 1) / kTaskChunks, [&](uint32_t task) {
        const uint32_t end = std::min(count, (task + 1) * kTaskChunks);
        for (uint32_t chunk = task * kTaskChunks; chunk < end; ++chunk)
            reached[chunk] = chunkReached(chunk);
    });
    return reached;
}

} // namespace relume
