#include "bake/solver/solver.h"

#include "assets/base/error.h"
#include "bake/vk/commands.h"

#include <array>
#include <cstring>

namespace relume {
namespace {

struct MethodName {
    Method method;
    const char* name;
};
constexpr std::array<MethodName, 7> kMethodNames = {{{Method::Pure, "pure"},
                                                     {Method::Static, "static"},
                                                     {Method::MonteCarlo, "montecarlo"},
                                                     {Method::Mipmapped, "mipmapped"},
                                                     {Method::Adaptive, "adaptive"},
                                                     {Method::Directional, "directional"},
                                                     {Method::Hybrid, "hybrid"}}};

} // namespace

Method parseMethod(const std::string& name) {
    for (const MethodName& n : kMethodNames) {
        if (name == n.name) return n.method;
    }
    throw UsageError(
        "--method " + name +
        ": unknown; choose pure, static, montecarlo, mipmapped, adaptive, directional or hybrid");
}

const char* methodName(Method method) {
    for (const MethodName& n : kMethodNames) {
        if (method == n.method) return n.name;
    }
    return "";
}

// The counters of the caches stay, since what these hold is this process' own.
void Solver::takeState(const SolverState& state, void* own, size_t size) {
    if (state.own.size() != size) throw Error("this state is not of such a solver: bake from the start");
    std::memcpy(own, state.own.data(), size);
    const uint64_t cacheBytes = progress_.cacheBytes;
    const double cachedShare = progress_.cachedShare;
    static_cast<SolverCounters&>(progress_) = state.counters;
    progress_.passSeconds = state.passSeconds;
    progress_.cacheBytes = cacheBytes;
    progress_.cachedShare = cachedShare;
}

StatePart Solver::part(const vk::Device& device, const vk::Buffer& buffer) {
    return {buffer.size(),
            [&](void* to, uint64_t offset, uint64_t size) { vk::download(device, buffer, to, size, offset); },
            [&](const void* from, uint64_t offset, uint64_t size) {
                vk::upload(device, buffer, from, size, offset);
            }};
}

StatePart Solver::part(ChunkOrder& order) {
    std::vector<uint8_t>& marks = order.marks();
    return {marks.size(),
            [&](void* to, uint64_t offset, uint64_t size) { std::memcpy(to, marks.data() + offset, size); },
            [&](const void* from, uint64_t offset, uint64_t size) {
                std::memcpy(marks.data() + offset, from, size);
            }};
}

template<typename T>
static StatePart partOf(std::vector<T>& values) {
    const auto bytes = [&values] { return reinterpret_cast<uint8_t*>(values.data()); };
    return {
        values.size() * sizeof(T),
        [=](void* to, uint64_t offset, uint64_t size) { std::memcpy(to, bytes() + offset, size); },
        [=](const void* from, uint64_t offset, uint64_t size) { std::memcpy(bytes() + offset, from, size); }};
}

StatePart Solver::part(std::vector<uint32_t>& values) {
    return partOf(values);
}

StatePart Solver::part(std::vector<double>& values) {
    return partOf(values);
}

void recordCopy(VkCommandBuffer cmd, const vk::Buffer& from, const vk::Buffer& to,
                const std::vector<ChunkRange>& ranges) {
    constexpr VkDeviceSize kChunkBytes = shader::kChunk * sizeof(glm::vec4);
    std::vector<VkBufferCopy> regions;
    for (const ChunkRange& range : ranges)
        regions.push_back({range.first * kChunkBytes, range.first * kChunkBytes, range.count * kChunkBytes});
    if (!regions.empty())
        vkCmdCopyBuffer(cmd, from.handle(), to.handle(), static_cast<uint32_t>(regions.size()),
                        regions.data());
}

} // namespace relume
