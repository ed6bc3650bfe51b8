#include "bake/show/publisher.h"

#include "bake/base/chunk_dispatch.h"
#include "bake/surface/seam_plan.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace relume {
namespace {

using shader::kRegion;

// A submit takes so many chunks: a million patches on a GPU, a quarter of that, some 10 ms, where the CPU
// does it.
constexpr uint32_t kChunksPerSubmit = 16384, kChunksPerSubmitSoftware = 4096;
// A submit copies so many texels: 32 MiB of them, below 20 ms through host memory on every device measured.
constexpr uint64_t kTexelsPerSubmit = uint64_t{1} << 22;

// Dispatches one workgroup for each of push.count chunks.
void dispatchGroups(const vk::ComputeProgram& program, VkCommandBuffer cmd, const shader::PublishPush& push) {
    if (push.count > 0) dispatchChunks(program, cmd, push, push.count);
}

// Returns the brightest lighting: light that bounces for ever between patches of albedo a is at most what the
// brightest one emits over 1 - a.
float brightestLighting(const PatchSet& set, float reflectivity) {
    constexpr float kMostAlbedo = 0.98f; // the RTRad preset has no bound of its own
    float emission = 0.0f, albedo = 0.0f;
    for (uint32_t i = 0; i < set.count; ++i) {
        const glm::vec4 &e = set.emission[i], &a = set.albedo[i];
        emission = std::max({emission, e.r, e.g, e.b});
        albedo = std::max({albedo, a.r, a.g, a.b});
    }
    return emission / (1.0f - std::min(reflectivity * albedo, kMostAlbedo));
}

// Calls f with portions of areas, of so many texels that a submit stays short.
template<typename F>
void forPortions(const std::vector<TexelArea>& areas, const F& f) {
    for (size_t first = 0; first < areas.size();) {
        uint64_t texels = 0;
        size_t end = first;
        while (end < areas.size() && (end == first || texels < kTexelsPerSubmit)) {
            texels += uint64_t{areas[end].width} * areas[end].height;
            ++end;
        }
        f(first, end);
        first = end;
    }
}

} // namespace

// At 2^14 the largest value leaves room for sampling noise four times as large, and what is 2^28 times
// smaller has all its bits.
float unitFor(float largest) {
    constexpr int kHighestBit = 14, kExponents = 100; // of a half; of a float, with room
    if (!(largest > 0.0f)) return 1.0f;
    int exponent = 0;
    (void)std::frexp(largest, &exponent);
    return std::ldexp(1.0f, std::clamp(exponent - kHighestBit, -kExponents, kExponents));
}

Publisher::Publisher(const vk::Device& device, const PatchSet& patches, const Desc& desc)
    : device_(device), size_(patches.scene.size), chunkCount_(patches.chunkCount()),
      chunksAtOnce_(
          std::min(device.info().software() ? kChunksPerSubmitSoftware : kChunksPerSubmit, chunkCount_)),
      rings_(patches.scene.rtrad ? std::min(desc.rings, 1u) : desc.rings), reflectivity_(desc.reflectivity),
      unit_(unitFor(brightestLighting(patches, desc.reflectivity))),
      scatter_(device, "publish", {patches.scene.rtrad ? 1u : 0u}), sum_(device, "publish_sum"),
      commands_(device), texels_(device, {.size = uint64_t{size_} * size_ * kTexelBytes, .name = "texels"}),
      patchTexels_(vk::makeBuffer(device, shownTexels(patches), "texel of patch")),
      chunks_(device, {.size = 2 * chunksAtOnce_ * sizeof(uint32_t),
                       .memory = vk::Memory::Host,
                       .name = "changed chunks"}),
      sums_(device,
            {.size = chunkCount_ * sizeof(glm::vec4), .memory = vk::Memory::Host, .name = "chunk sums"}),
      allChunks_(chunkCount_), hasFills_(chunkCount_, 0) {
    const SeamPlan plan = buildSeamPlan(patches, rings_);
    fills_ = vk::makeBuffer(device, plan.fills, "seam fills");
    starts_ = vk::makeBuffer(device, plan.starts, "seam starts");
    for (uint32_t ring = 1; ring <= rings_; ++ring)
        for (uint32_t c = 0; c < chunkCount_; ++c)
            hasFills_[c] |=
                static_cast<uint8_t>(plan.starts[plan.at(ring, c)] < plan.starts[plan.at(ring, c) + 1]);
    const uint32_t regions = regionsPerRow() * regionsPerRow();
    changed_ = vk::Buffer(device, {.size = regions * sizeof(uint32_t), .name = "changed regions"});
    report_ = vk::Buffer(
        device, {.size = changed_.size(), .memory = vk::Memory::Host, .name = "changed regions, read"});
    std::iota(allChunks_.begin(), allChunks_.end(), 0u);
    outdated_.fill(std::vector<uint8_t>(regions, 1));
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, texels_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    commands_.run();
}

void Publisher::updateUnit(const PatchSet& patches) {
    unit_ = unitFor(brightestLighting(patches, reflectivity_));
}

void Publisher::update(const Update& update) {
    const std::span<const uint32_t> chunks = updated_ ? update.chunks : allChunks();
    if (chunks.empty()) return;
    ASSERT(chunks.size() <= chunkCount_ && update.values.size() >= patchTexels_.size() * 4);
    shader::PublishPush push{.values = update.values.address(),
                             .patchTexels = patchTexels_.address(),
                             .fills = fills_.address(),
                             .starts = starts_.address(),
                             .chunks = chunks_.address(),
                             .texels = texels_.address(),
                             .changed = changed_.address(),
                             .sums = sums_.address(),
                             .first = 0,
                             .count = 0,
                             .chunkCount = chunkCount_,
                             .size = size_,
                             .ring = 0,
                             .scale = 1.0f / update.unit};
    for (size_t first = 0; first < chunks.size(); first += chunksAtOnce_) {
        const auto portion = chunks.subspan(first, std::min<size_t>(chunksAtOnce_, chunks.size() - first));
        VkCommandBuffer cmd = commands_.begin();
        vk::barrier(cmd);
        if (first == 0) {
            vkCmdFillBuffer(cmd, changed_.handle(), 0, VK_WHOLE_SIZE, 0);
            vk::barrier(cmd);
        }
        recordUpdate(cmd, push, portion);
        if (first + portion.size() == chunks.size()) {
            const VkBufferCopy whole{0, 0, changed_.size()};
            vkCmdCopyBuffer(cmd, changed_.handle(), report_.handle(), 1, &whole);
        }
        vk::hostBarrier(cmd);
        commands_.run();
    }
    readReport();
    updated_ = true;
}

// Records an update. Chunks beside no empty texel, most of them, are left out of the fills.
void Publisher::recordUpdate(VkCommandBuffer cmd, shader::PublishPush push,
                             std::span<const uint32_t> chunks) {
    auto* list = chunks_.as<uint32_t>();
    std::copy(chunks.begin(), chunks.end(), list);
    push.first = 0;
    push.count = static_cast<uint32_t>(chunks.size());
    sum_.dispatch(cmd, push, (push.count + shader::kChunk - 1) / shader::kChunk);
    dispatchGroups(scatter_, cmd, push);
    uint32_t* end = list + chunksAtOnce_;
    for (uint32_t chunk : chunks)
        if (hasFills_[chunk] != 0) *end++ = chunk;
    push.first = chunksAtOnce_;
    push.count = static_cast<uint32_t>(end - list) - chunksAtOnce_;
    for (push.ring = 1; push.ring <= rings_; ++push.ring) {
        vk::barrier(cmd);
        dispatchGroups(scatter_, cmd, push);
    }
    vk::barrier(cmd);
}

void Publisher::readReport() {
    const auto* changed = report_.as<uint32_t>();
    for (std::vector<uint8_t>& slot : outdated_)
        for (size_t r = 0; r < slot.size(); ++r)
            slot[r] |= static_cast<uint8_t>(changed[r]);
    glm::dvec4 sum(0.0);
    for (uint32_t i = 0; i < chunkCount_; ++i)
        sum += glm::dvec4(sums_.as<glm::vec4>()[i]);
    mean_ = sum.w > 0.0 ? glm::vec3(glm::dvec3(sum) / sum.w) : glm::vec3(0.0f);
}

void Publisher::forget() {
    for (std::vector<uint8_t>& slot : outdated_)
        std::fill(slot.begin(), slot.end(), uint8_t{1});
}

// Returns runs of regions side by side; what lies right below a run of the same columns is added to it.
std::vector<TexelArea> Publisher::changedAreas(uint32_t slot) const {
    const uint32_t row = regionsPerRow();
    std::vector<TexelArea> areas;
    const auto add = [&](const TexelArea& run) {
        const auto above = std::find_if(areas.begin(), areas.end(), [&](const TexelArea& a) {
            return a.x == run.x && a.width == run.width && a.y + a.height == run.y &&
                   uint64_t{a.width} * a.height < kTexelsPerSubmit;
        });
        if (above != areas.end())
            above->height += run.height;
        else
            areas.push_back(run);
    };
    for (uint32_t y = 0; y < row; ++y) {
        const auto outdated = [&](uint32_t x) {
            return x < row && outdated_[slot][size_t{y} * row + x] != 0;
        };
        const uint32_t top = y * kRegion, height = std::min(kRegion, size_ - top);
        for (uint32_t x = 0; x < row; ++x) {
            const uint32_t first = x;
            while (outdated(x))
                ++x;
            const uint32_t left = first * kRegion;
            if (x > first) add({left, top, std::min(x * kRegion, size_) - left, height});
        }
    }
    return areas;
}

std::vector<TexelArea> Publisher::publish(const vk::SharedImage& image, uint32_t slot) {
    ASSERT(slot < kSlots && image.width() == size_ && image.height() == size_);
    const std::vector<TexelArea> areas = changedAreas(slot);
    forPortions(areas, [&](size_t first, size_t end) {
        std::vector<VkBufferImageCopy> copies;
        for (size_t i = first; i < end; ++i) {
            const TexelArea& a = areas[i];
            VkBufferImageCopy copy{};
            copy.bufferOffset = (uint64_t{a.y} * size_ + a.x) * kTexelBytes;
            copy.bufferRowLength = size_;
            copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            copy.imageOffset = {static_cast<int32_t>(a.x), static_cast<int32_t>(a.y), 0};
            copy.imageExtent = {a.width, a.height, 1};
            copies.push_back(copy);
        }
        VkCommandBuffer cmd = commands_.begin();
        vk::barrier(cmd);
        image.acquire(cmd);
        vkCmdCopyBufferToImage(cmd, texels_.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                               static_cast<uint32_t>(copies.size()), copies.data());
        image.release(cmd);
        commands_.run();
    });
    std::fill(outdated_[slot].begin(), outdated_[slot].end(), uint8_t{0});
    return areas;
}

// Returns the device's own memory where the host sees it, else a copy of whole rows, which are contiguous.
const std::byte* Publisher::hostTexels(const std::vector<TexelArea>& areas) {
    if (texels_.mapped() != nullptr) return texels_.as<std::byte>();
    if (!staging_) {
        staging_ = vk::Buffer(
            device_, {.size = texels_.size(), .memory = vk::Memory::Host, .name = "texels on the host"});
    }
    std::vector<uint8_t> rows(regionsPerRow(), 0);
    for (const TexelArea& a : areas)
        for (uint32_t y = a.y; y < a.y + a.height; y += kRegion)
            rows[y / kRegion] = 1;
    std::vector<VkBufferCopy> copies;
    const uint64_t rowBytes = uint64_t{size_} * kTexelBytes;
    for (uint32_t r = 0; r < rows.size(); ++r) {
        if (rows[r] == 0) continue;
        const uint32_t first = r * kRegion, end = std::min(first + kRegion, size_);
        copies.push_back({first * rowBytes, first * rowBytes, (end - first) * rowBytes});
    }
    VkCommandBuffer cmd = commands_.begin();
    vk::barrier(cmd);
    vkCmdCopyBuffer(cmd, texels_.handle(), staging_.handle(), static_cast<uint32_t>(copies.size()),
                    copies.data());
    vk::hostBarrier(cmd);
    commands_.run();
    return staging_.as<std::byte>();
}

std::vector<TexelArea> Publisher::publish(std::span<std::byte> texels, uint32_t slot) {
    ASSERT(slot < kSlots && texels.size() == texels_.size());
    std::vector<TexelArea> areas = changedAreas(slot);
    if (areas.empty()) return areas;
    const std::byte* from = hostTexels(areas);
    for (const TexelArea& a : areas) {
        for (uint32_t y = a.y; y < a.y + a.height; ++y) {
            const size_t at = (size_t{y} * size_ + a.x) * kTexelBytes;
            std::memcpy(texels.data() + at, from + at, a.width * kTexelBytes);
        }
    }
    std::fill(outdated_[slot].begin(), outdated_[slot].end(), uint8_t{0});
    return areas;
}

} // namespace relume
