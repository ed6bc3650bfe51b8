#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/base/shader_types.h"

namespace relume {

struct EndBox {
    glm::vec3 lo, hi; // [m], lo > hi: empty
};

/// A chunk's patches by component, for loops over eight at a time.
struct alignas(64) PatchChunk {
    using Lane = std::array<float, shader::kChunk>;
    Lane px, py, pz; // position [m]
    Lane nx, ny, nz; // geometric normal
    Lane offset;     // [m]
    Lane ex, ey, ez; // where rays end: position + offset * normal, the bare position with rtrad [m];
                     // where a patch does not send: those of one that does
    EndBox ends;     // of the ends of all rays
    std::array<EndBox, 4> quarterEnds; // of those of the patches in kQuarter[0..3]
    uint64_t sends;                    // bit j: patch j has kPatchSends
    glm::vec3 lo, hi;                  // bounds of the positions of those [m]
    glm::vec3 plane;                   // the normal they all share, (0,0,0) where they do not
    float height;                      // smallest dot(position, plane) [m]
    float margin;                      // smallest offset [m]
};

/// The patches of the quarters of a full tile of 8 x 8; their boxes are smaller all round.
constexpr std::array<uint64_t, 4> kQuarter = {0x000000000f0f0f0full, 0x00000000f0f0f0f0ull,
                                              0x0f0f0f0f00000000ull, 0xf0f0f0f000000000ull};

std::vector<PatchChunk> buildChunks(const std::vector<shader::Patch>& patches, bool rtrad);
/// Builds a chunk of any 64 patches.
PatchChunk buildChunk(const shader::Patch* patches, bool rtrad);

/// Returns false only if no patch of a faces one of b (shader::pairFaces); it is cheap, and may return true
/// all the same.
bool chunksMayFace(const PatchChunk& a, const PatchChunk& b);

/// Returns a word whose bit j says that patch `row` of a and patch j of b face each other, exactly as
/// shader::pairFaces has it.
uint64_t facingRow(const PatchChunk& a, uint32_t row, const PatchChunk& b);

/// Does the same for all 64 rows. It picks AVX at run time where the processor has it; the arithmetic is the
/// same.
void facingRows(const PatchChunk& a, const PatchChunk& b, std::array<uint64_t, shader::kChunk>& rows);

} // namespace relume
