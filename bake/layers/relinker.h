#pragma once

#include <optional>

#include "bake/gather/link_batches.h"
#include "bake/layers/object_move.h"

namespace relume {

/// Brings the links that are kept to where objects are now: those that may meet what moved are traced again,
/// with the directions that they were made of.
class Relinker {
public:
    Relinker(LinkKit& kit, LinkCache& links) : kit_(kit), links_(links) {}

    /// Takes up a move. Where an object moves on while links still follow it, all ways count.
    void follow(const ObjectMove& move);
    /// Returns the sample pass whose links come next; nothing where all have followed.
    std::optional<uint32_t> samplePass() const {
        return relink_ ? std::optional(relink_->samplePass) : std::nullopt;
    }
    /// Returns the move that some links have not followed yet; nothing where all have.
    std::optional<ObjectMove> pending() const {
        return relink_ ? std::optional(relink_->late.move) : std::nullopt;
    }
    /// Traces a batch. Needs samplePass().
    void batch();

private:
    /// The places where objects were and are, for tracers.
    struct Path {
        ObjectMove move;
        vk::Buffer boxes, changed, ends; // ends may be left out
    };
    /// Kept links on their way to where objects are now.
    struct Relink {
        Path early, late; // for the first earlySamplePasses sample passes, for the others
        uint32_t earlySamplePasses = 0;
        vk::Buffer list;
        BatchRate rate;
        uint32_t samplePass = 0, chunk = 0; // next
    };
    uint32_t retrace(Relink& relink, uint32_t most);

    LinkKit& kit_;
    LinkCache& links_;
    std::optional<Relink> relink_;
};

} // namespace relume
