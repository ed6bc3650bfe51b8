#pragma once

#include "bake/solver/solver.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/commands.h"

namespace relume {

/// Knows for each row of super-blocks which light is newer than what a viewer has: that of the last pass, or
/// that of the pass under way where the row is through.
class FreshRows {
public:
    explicit FreshRows(uint32_t chunks);

    /// Lets everything come from the last pass.
    void startOver();
    /// Takes note that a row has all its light of the pass under way.
    void end(uint32_t row) { rows_[row] = Fresh::LigOut; }
    /// Takes note that the pass has become the last one; `all` says that no row was shown before.
    void endPass(bool all);
    /// The chunks that are new, merged().
    struct Chunks {
        std::vector<ChunkRange> fromLast, fromPass;
    };
    /// Returns what is new since the call before.
    Chunks take();

private:
    enum class Fresh : uint8_t { No, LigIn, LigOut };
    uint32_t chunks_;
    std::vector<Fresh> rows_;
};

/// Keeps what a viewer is shown of a pair method: the last pass, and rows of the one under way.
class PairView {
public:
    /// Makes a buffer for it where somebody watches.
    PairView(const vk::Device& device, const PatchSet& patches, bool live);

    FreshRows& rows() { return rows_; }
    /// Brings the light up to date. `complete` says that it has all bounces; it stays so until startOver().
    LiveLight look(vk::Commands& commands, const LightBuffers& light, bool complete);
    /// Begins anew, from other light.
    void startOver();

private:
    FreshRows rows_;
    vk::Buffer light_; // vec4 per patch
    uint64_t version_ = 0;
    bool complete_ = false;
};

} // namespace relume
