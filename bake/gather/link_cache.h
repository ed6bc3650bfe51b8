#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/vk/buffer.h"

namespace relume {

/// Keeps links as long as there is memory: light is gathered over them again without a ray (the transport
/// cache). It knows where links are, not how they are traced.
class LinkCache {
public:
    struct Desc {
        uint32_t chunkCount = 0;
        uint32_t links = 16; // per patch and sample pass
        uint32_t batch = 1;  // chunks of a batch of links that are not kept, at most
        uint64_t bytes = 0;  // at most
        uint64_t deviceBytes =
            0; // of them on the device, the first ones; the others are in the host's memory
        // The chunks that will be asked for: ascending runs, which no question reaches beyond. Empty: all.
        std::vector<ChunkRange> chunks = {};
        // Whole sample passes are kept, the first ones, and memory is taken as they come. Or those of one
        // sample pass at a time are kept, of the first chunks where there is no room for all; memory for
        // these is taken at once.
        bool oneSamplePass = false;
    };
    LinkCache(const vk::Device& device, const Desc& desc);
    /// Returns the most bytes that such a cache takes; where sample passes are kept as they come, without
    /// these.
    static uint64_t mostBytes(const Desc& desc);
    /// The ledger counts kept links as those of this owner (vk::MemoryOwner).
    static constexpr const char* kOwner = "link cache";

    struct Place {
        const vk::Buffer* links = nullptr; // uint[chunk][links][64]
        uint64_t offset = 0;               // [links], of the first chunk that was asked for
        bool known = false;                // they are there; else to be traced
        uint32_t count = 0;                // chunks from that one on that are alike
    };
    /// Returns the place of the links of up to `most` chunks from `first` on, of a batch that has had so many
    /// chunks `before`: none where it has no room for more.
    Place find(uint32_t samplePass, uint32_t first, uint32_t most, uint32_t before = 0);
    /// Takes the memory for the links of a sample pass that will be asked for next, where whole ones are
    /// kept: a GPU's driver takes 20 ms for each GB, which find() would wait for.
    void prepare(uint32_t samplePass) { keepIfRoom(samplePass); }
    /// Returns a place for links that are read once: those of up to `most` chunks with so many sample passes
    /// each. What is kept of a sample pass is forgotten first.
    Place passing(uint32_t samplePasses, uint32_t most);
    /// Notes that the links of these chunks were traced to where find() said.
    void note(uint32_t samplePass, ChunkRange range);
    /// Forgets all links, but keeps the memory.
    void forget();

    /// The links of a sample pass, or of some chunks where one sample pass is kept at a time.
    struct SamplePass {
        vk::Buffer links;           // uint[chunk][links][64]
        std::vector<uint8_t> known; // per chunk that is kept
    };
    /// Gives away the sample passes that are kept, without the last ones of which no link is known yet.
    std::deque<SamplePass> release();
    /// Takes them over as they are, as far as there is room; of as many chunks, with as many links each.
    void takeOver(std::deque<SamplePass> samplePasses);

    uint64_t bytes() const; // in use
    uint32_t samplePasses() const { return static_cast<uint32_t>(kept_.size()); }
    /// Returns how much of a sample pass is kept, where one is kept at a time.
    double share() const { return static_cast<double>(samplePassChunks_) / asked_; }

private:
    /// A chunk's place: in which of kept_, and where in it.
    struct Slot {
        size_t kept = 0;
        uint32_t at = 0;
    };
    void keepIfRoom(uint32_t samplePass);
    void keep(uint32_t chunks, vk::Memory memory);
    uint32_t numberOf(uint32_t chunk) const;
    std::optional<Slot> slotOf(uint32_t samplePass, uint32_t chunk) const;
    Place inStaging(uint32_t most, uint32_t before);

    const vk::Device& device_;
    Desc desc_;
    uint64_t chunkBytes_;
    uint32_t asked_;              // chunks that will be asked for
    uint32_t samplePassChunks_;   // kept of a sample pass
    uint32_t deviceChunks_;       // of these on the device, where one is kept at a time
    std::deque<SamplePass> kept_; // a Place points into it while more are added
    vk::Buffer staging_;          // of a batch beyond the kept ones
};

} // namespace relume
