#include "bake/pairs/pair_senders.h"

#include "bake/pairs/quad_tree.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kChunk;

bool isLit(const glm::vec4& radiance) {
    return radiance.r != 0.0f || radiance.g != 0.0f || radiance.b != 0.0f;
}

} // namespace

PairSenders::PairSenders(const SolverInput& input, const SolverSettings& settings)
    : device_(input.device), patches_(input.patches), light_(input.light), transport_(settings.transport),
      pairs_(settings.pairs), adaptive_(settings.method == Method::Adaptive) {
    const bool rtrad = transport_.rtrad;
    switch (settings.method) {
    case Method::Static:
    case Method::MonteCarlo:
    case Method::Mipmapped: {
        const bool random = settings.method == Method::MonteCarlo,
                   mips = settings.method == Method::Mipmapped;
        kind_ = random && !rtrad ? SenderKind::Drawn : SenderKind::List;
        if (mips) lightKind_ = rtrad ? SenderLight::RtradMips : SenderLight::Mean;
        setList(rtrad ? rtradSenders(patches_, pairs_.window, random)
                      : windowSenders(patches_, pairs_.window));
        break;
    }
    case Method::Adaptive:
        kind_ = SenderKind::List;
        lightKind_ = rtrad ? SenderLight::RtradTree : SenderLight::Mean;
        parts_ = mergeableParts(patches_);
        break;
    default:
        break;
    }
}

uint32_t PairSenders::columns() const {
    return kind_ == SenderKind::Patches ? patches_.chunkCount() : list_.chunkCount();
}

uint32_t PairSenders::maxColumns() const {
    return adaptive_ ? patches_.chunkCount() : columns();
}

const vk::Buffer& PairSenders::sendsBuffer() const {
    return kind_ == SenderKind::Patches ? light_.chunkSends : buffers_.sends;
}

void PairSenders::setList(SenderList list) {
    // A chunk keeps its bits if the patches that stand for its senders are the same.
    changed_.assign(list.chunkCount(), true);
    const auto face = [](const SenderList& l, size_t i) {
        return l.senders[i].count > 0 ? l.members[l.senders[i].first] : shader::kNoPatch;
    };
    for (uint32_t chunk = 0; chunk < std::min(list.chunkCount(), list_.chunkCount()); ++chunk) {
        bool same = true;
        for (size_t i = size_t{chunk} * kChunk; i < size_t{chunk + 1} * kChunk; ++i)
            same = same && face(list, i) == face(list_, i);
        changed_[chunk] = !same;
    }
    list_ = std::move(list);
    traced_ = list_.senders;
    if (kind_ != SenderKind::Drawn)
        for (shader::Sender& sender : traced_)
            sender.count = std::min(sender.count, 1u);
    buffers_ = {}; // before its successor takes memory
    buffers_.senders = vk::makeBuffer(device_, traced_, "senders");
    buffers_.members = vk::makeBuffer(device_, list_.members, "members of senders");
    if (kind_ != SenderKind::Drawn) {
        buffers_.patches = vk::makeBuffer(device_, list_.patches, "sender shapes");
        buffers_.edges = vk::makeBuffer(device_, list_.edges, "sender edges");
        buffers_.radiance = vk::Buffer(
            device_, {.size = list_.senders.size() * sizeof(glm::vec4), .name = "sender radiance"});
    }
    buffers_.bounds = vk::makeBuffer(device_, list_.bounds, "sender bounds");
    buffers_.sends =
        vk::Buffer(device_, {.size = list_.chunkCount() * sizeof(uint32_t), .name = "sender chunk sends"});
    buffers_.chunkCount = list_.chunkCount();
    runs_ = {.senders = traced_,
             .members = list_.members,
             .senderBuffer = &buffers_.senders,
             .memberBuffer = &buffers_.members};
}

uint64_t PairSenders::bytes(uint64_t senders, uint64_t members, SenderKind kind) {
    const uint64_t shapes = kind == SenderKind::Drawn ? 0
                                                      : sizeof(shader::Patch) + sizeof(shader::PatchEdges) +
                                                            sizeof(glm::vec4); // and radiance
    return senders * (sizeof(shader::Sender) + shapes) + members * sizeof(uint32_t) +
           senders / kChunk * (sizeof(shader::ChunkBounds) + sizeof(uint32_t));
}

void PairSenders::prepare(const std::vector<glm::vec4>& light, double threshold) {
    if (kind_ == SenderKind::Patches) {
        sends_ = vk::readBuffer<uint32_t>(device_, light_.chunkSends, patches_.chunkCount());
        changed_.assign(sends_.size(), false);
        return;
    }
    if (kind_ == SenderKind::Drawn) {
        changed_.assign(list_.chunkCount(), false);
        return listSending(vk::readBuffer<uint32_t>(device_, light_.chunkSends, patches_.chunkCount()));
    }
    const std::vector<glm::vec4> radiance = patchRadiance(patches_, light, transport_);
    if (adaptive_) {
        setList(quadTreeSenders(
            patches_, parts_, radiance,
            {.node = pairs_.node, .threshold = static_cast<float>(threshold), .rtrad = transport_.rtrad}));
    } else {
        changed_.assign(list_.chunkCount(), false);
    }
    sendRadiance(radiance);
}

void PairSenders::sendRadiance(const std::vector<glm::vec4>& radiance) {
    sends_.assign(list_.chunkCount(), 0);
    const std::vector<glm::vec4> sent = senderRadiance(patches_, list_, radiance, lightKind_, pairs_.window);
    for (size_t i = 0; i < sent.size(); ++i)
        if (isLit(sent[i])) sends_[i / kChunk] = 1;
    vk::upload(device_, buffers_.radiance, sent.data(), sent.size() * sizeof(glm::vec4));
    uploadSends();
}

// Notes the chunks of senders that may draw from a chunk of patches that sends.
void PairSenders::listSending(const std::vector<uint32_t>& chunkSends) {
    sends_.assign(list_.chunkCount(), 0);
    for (uint32_t i = 0; i < list_.count; ++i) {
        if (sends_[i / kChunk] != 0) continue;
        const shader::Sender& s = list_.senders[i];
        const auto first = list_.members.begin() + s.first;
        if (std::any_of(first, first + s.count, [&](uint32_t m) { return chunkSends[m / kChunk] != 0; }))
            sends_[i / kChunk] = 1;
    }
    uploadSends();
}

void PairSenders::uploadSends() {
    if (transport_.allSend) std::fill(sends_.begin(), sends_.end(), 1u);
    vk::upload(device_, buffers_.sends, sends_.data(), sends_.size() * sizeof(uint32_t));
}

} // namespace relume
