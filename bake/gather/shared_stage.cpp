#include "bake/gather/shared_stage.h"

namespace relume {
namespace {

constexpr VkDeviceSize kGrain = 1 << 16; // a multiple of what devices want of imported memory [bytes]

} // namespace

std::optional<VkDeviceSize> SharedStage::turn(VkDeviceSize bytes) {
    ASSERT(bytes > 0);
    reserve(bytes);
    if (none_) return std::nullopt;
    second_ = !second_;
    return second_ ? half_ : 0;
}

// Ranks decide together, so that none waits for what another one sends otherwise.
bool SharedStage::grow(VkDeviceSize bytes) {
    const vk::MemoryOwner owner("ranks");
    buffer_ = {}; // before the larger one takes its memory
    block_ = {};
    half_ = (bytes + kGrain - 1) / kGrain * kGrain;
    block_ = ranks_.share(2 * half_);
    bool has = block_ && vk::Buffer::importable(device_, block_.bytes);
    try {
        if (has)
            buffer_ = vk::Buffer(device_, {.size = block_.bytes.size(),
                                           .memory = vk::Memory::Host,
                                           .name = "what ranks share",
                                           .imported = block_.bytes});
    } catch (const Error&) { // a driver may refuse any memory; then what is sent goes by messages
        has = false;
    }
    if (ranks_.sum(has ? 0 : 1) == 0) return true;
    buffer_ = {};
    block_ = {};
    return false;
}

} // namespace relume
