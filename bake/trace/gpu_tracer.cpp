#include "bake/trace/gpu_tracer.h"

#include "bake/base/retrace_types.h"
#include "bake/vk/accel.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
constexpr uint32_t kSamplesPerInvocation = 8; // lib/rays/closest.glsl

uint32_t segmentWords(const SegmentWork& work) {
    return (work.targetCount + kTargetsPerWord - 1) / kTargetsPerWord;
}

VkDeviceAddress addressOf(const vk::Buffer* buffer) {
    return buffer ? buffer->address() : 0;
}

// The tables of a TraceScene on the device, and the push constants that point to them.
class SceneBuffers {
public:
    SceneBuffers(const vk::Device& device, const TraceScene& scene, const vk::Buffer& patches)
        : hitTriangles_(vk::makeBuffer(device, scene.hitTriangles, "hit triangles")),
          texelToPatch_(vk::makeBuffer(device, scene.texelToPatch, "texel to patch")),
          patchChart_(vk::makeBuffer(device, scene.sendingCharts(), "chart of patch")),
          alphaTriangles_(vk::makeBuffer(device, scene.alphaTriangles, "alpha triangles")),
          alphaMaterials_(vk::makeBuffer(device, scene.alphaMaterials, "alpha materials")),
          alphaTexels_(vk::makeBuffer(device, wholeWords(scene.alphaTexels), "alpha texels")),
          patches_(patches.address()), size_(scene.size), chunkCount_(scene.chunkCount()),
          rtrad_(scene.rtrad) {
        geometry_ = {.accel = 0,
                     .triangles = 0,
                     .alphaTriangles = alphaTriangles_.address(),
                     .alphaMaterials = alphaMaterials_.address(),
                     .alphaTexels = alphaTexels_.address(),
                     .opaqueCount = scene.mesh.opaqueCount,
                     .triangleCount = scene.mesh.triangleCount()};
    }
    void update(const vk::Device& device, const TraceScene& scene, const SceneChange& change) {
        vk::uploadElements(device, hitTriangles_, scene.hitTriangles, change.triangles);
        vk::uploadElements(device, texelToPatch_, scene.texelToPatch, change.texels);
    }
    void updateSenders(const vk::Device& device, const TraceScene& scene, std::span<const uint32_t> patches) {
        vk::uploadMade<uint32_t>(device, patchChart_, patches,
                                 [&](uint32_t patch) { return scene.sendingChart(patch); });
    }
    void setAccel(VkDeviceAddress accel, VkDeviceAddress triangles) {
        geometry_.accel = accel;
        geometry_.triangles = triangles;
    }

    shader::OcclusionPush push(const OcclusionWork& work, uint32_t groupsX) const {
        const SenderRuns* list = work.senders;
        return {.geometry = geometry_,
                .patches = patches_,
                .supers = work.superBuffer->address(),
                .sends = work.sends->address(),
                .senders = list ? list->senderBuffer->address() : 0,
                .members = list ? list->memberBuffer->address() : 0,
                .rays = work.rays->address(),
                .firstUnit = work.firstUnit,
                .unitCount = work.unitCount,
                .rowCount = chunkCount_,
                .columnCount = list ? static_cast<uint32_t>(list->senders.size() / kChunk) : chunkCount_,
                .flags =
                    (rtrad_ ? shader::kOcclusionRtrad : 0) | (work.reversed ? shader::kOcclusionReversed : 0),
                .groupsX = groupsX};
    }
    shader::ClosestPush push(const ClosestWork& work) const {
        ASSERT(work.sampleCount % kSamplesPerInvocation == 0);
        return {.geometry = geometry_,
                .patches = work.receivers ? work.receivers->address() : patches_,
                .links = work.links->address() + work.linksOffset * sizeof(uint32_t),
                .hitTriangles = hitTriangles_.address(),
                .texelToPatch = texelToPatch_.address(),
                .patchChart = patchChart_.address(),
                .covers = work.receivers ? 0 : addressOf(work.covers),
                .disc = addressOf(work.disc),
                .firstChunk = work.firstChunk,
                .firstSample = work.firstSample,
                .sampleCount = work.sampleCount,
                .size = size_,
                .rotation = static_cast<uint32_t>(work.rotation),
                .discCount = work.disc ? work.discCount : 0};
    }

    shader::SegmentPush push(const SegmentWork& work) const {
        return {.geometry = geometry_,
                .patches = patches_,
                .targets = work.targets->address(),
                .bits = work.bits->address(),
                .rays = work.rays->address(),
                .covers = addressOf(work.covers),
                .chunks = addressOf(work.chunks),
                .firstChunk = work.firstChunk,
                .targetCount = work.targetCount,
                .samplePass = work.samplePass,
                .turn = work.turn,
                .run = work.run};
    }

    shader::RetraceMarkPush markPush(const RetraceWork& work) const {
        return {.patches = patches_,
                .boxes = work.boxes->address(),
                .changed = work.changed->address(),
                .links = push(work.closest).links,
                .ends = addressOf(work.ends),
                .list = work.list->address(),
                .rays = work.rays->address(),
                .covers = addressOf(work.closest.covers),
                .boxCount = work.boxCount,
                .firstChunk = work.closest.firstChunk,
                .firstSample = work.closest.firstSample,
                .sampleCount = work.closest.sampleCount,
                .size = size_,
                .rotation = static_cast<uint32_t>(work.closest.rotation),
                .silent = work.silent ? 1u : 0u};
    }
    shader::RetracePush push(const RetraceWork& work) const {
        const shader::ClosestPush all = push(work.closest);
        return {.geometry = geometry_,
                .patches = patches_,
                .links = all.links,
                .hitTriangles = hitTriangles_.address(),
                .texelToPatch = texelToPatch_.address(),
                .patchChart = patchChart_.address(),
                .list = work.list->address(),
                .covers = all.covers,
                .firstChunk = all.firstChunk,
                .firstSample = all.firstSample,
                .sampleCount = all.sampleCount,
                .size = size_,
                .rotation = all.rotation,
                .silent = work.silent ? 1u : 0u};
    }

private:
    static std::vector<uint8_t> wholeWords(std::vector<uint8_t> bytes) {
        bytes.resize((bytes.size() + 3) / 4 * 4);
        return bytes;
    }

    vk::Buffer hitTriangles_, texelToPatch_, patchChart_, alphaTriangles_, alphaMaterials_, alphaTexels_;
    VkDeviceAddress patches_ = 0;
    uint32_t size_ = 0, chunkCount_ = 0;
    bool rtrad_ = false;
    shader::TraceGeometry geometry_{};
};

// Lists the links that are to be traced again. It writes the barriers around that.
class RetraceMarks {
public:
    explicit RetraceMarks(const vk::Device& device) : mark_(device, "retrace_mark") {}
    void record(VkCommandBuffer cmd, const SceneBuffers& buffers, const RetraceWork& work) const {
        ASSERT(!work.closest.receivers && !work.closest.disc);
        vkCmdFillBuffer(cmd, work.list->handle(), 0, sizeof(uint32_t), 0);
        vk::barrier(cmd);
        mark_.dispatch(cmd, buffers.markPush(work), work.closest.chunkCount,
                       work.closest.sampleCount / kSamplesPerInvocation);
        vk::barrier(cmd);
    }

private:
    vk::ComputeProgram mark_;
};

// So many groups of a chunk's invocations share a list, as many as fill the device.
constexpr uint32_t kGpuRetraceGroups = 8192, kSoftwareRetraceGroups = 64;
uint32_t retraceGroups(const vk::Device& device) {
    return device.info().software() ? kSoftwareRetraceGroups : kGpuRetraceGroups;
}

// The base of all compute tracers; they differ in the acceleration structure and in the shaders' variant.
class ComputeTracer : public Tracer {
public:
    ComputeTracer(const vk::Device& device, const TraceScene& scene, const vk::Buffer& patches,
                  const std::string& name)
        : device_(device), scene_(scene), buffers_(device, scene, patches), name_(name),
          occlusion_(device, "occlusion_" + name),
          closest_(device, "closest_" + name, {device.info().software() ? 0u : 1u}),
          segments_(device, "segments_" + name) {}

    const char* name() const override { return name_.c_str(); }
    bool onCpu() const override { return false; }

    void occlusion(VkCommandBuffer cmd, const OcclusionWork& work) override {
        const uint32_t groups = work.unitCount * 2;
        const uint32_t groupsX = std::min(groups, kGroupsX);
        occlusion_.dispatch(cmd, buffers_.push(work, groupsX), groupsX, (groups + groupsX - 1) / groupsX);
    }
    void closest(VkCommandBuffer cmd, const ClosestWork& work) override {
        closest_.dispatch(cmd, buffers_.push(work), work.chunkCount,
                          work.sampleCount / kSamplesPerInvocation);
    }
    void segments(VkCommandBuffer cmd, const SegmentWork& work) override {
        segments_.dispatch(cmd, buffers_.push(work), work.chunkCount, segmentWords(work));
    }

    void updateSenders(std::span<const uint32_t> patches) override {
        buffers_.updateSenders(device_, scene_, patches);
    }
    void retrace(VkCommandBuffer cmd, const RetraceWork& work) override {
        if (!marks_) {
            marks_.emplace(device_);
            retrace_ = vk::ComputeProgram(device_, "retrace_" + name_);
        }
        marks_->record(cmd, buffers_, work);
        retrace_.dispatch(cmd, buffers_.push(work), retraceGroups(device_));
    }

protected:
    static constexpr uint32_t kGroupsX = 32768; // below every device's maxComputeWorkGroupCount
    const vk::Device& device_;
    const TraceScene& scene_;
    SceneBuffers buffers_;

private:
    std::string name_;
    vk::ComputeProgram occlusion_, closest_, segments_, retrace_;
    std::optional<RetraceMarks> marks_; // once objects move
};

class BvhTracer final : public ComputeTracer {
public:
    BvhTracer(const vk::Device& device, const TraceScene& scene, const vk::Buffer& patches, MovingBvh tree)
        : ComputeTracer(device, scene, patches, "bvh"), tree_(std::move(tree)) {
        put(nodes_, tree_.bvh().nodes, {}, "bvh nodes");
        put(triangles_, tree_.bvh().triangles, {}, "bvh triangles");
        buffers_.setAccel(nodes_.address(), triangles_.address());
    }
    bool follows() const override { return true; }
    void update(const SceneChange& change) override {
        buffers_.update(device_, scene_, change);
        const MovingBvh::Change moved = tree_.follow(scene_.mesh, change.triangles);
        if (moved.all) {
            nodes_ = {};
            triangles_ = {};
        }
        put(nodes_, tree_.bvh().nodes, moved.nodes, "bvh nodes");
        put(triangles_, tree_.bvh().triangles, moved.triangles, "bvh triangles");
        buffers_.setAccel(nodes_.address(), triangles_.address());
    }

private:
    // Uploads those that changed, or all of them into a larger buffer, with room for the next object that
    // moves.
    template<typename T>
    void put(vk::Buffer& buffer, const std::vector<T>& values, std::span<const uint32_t> changed,
             const char* name) {
        const VkDeviceSize bytes = values.size() * sizeof(T);
        if (buffer && bytes <= buffer.size()) return vk::uploadElements(device_, buffer, values, changed);
        const bool first = !buffer;
        buffer = {};
        buffer = vk::Buffer(device_, {.size = first ? bytes : bytes + bytes / kRoom, .name = name});
        vk::upload(device_, buffer, values.data(), bytes);
    }
    static constexpr VkDeviceSize kRoom = 8; // an eighth more than there is

    MovingBvh tree_;
    vk::Buffer nodes_, triangles_;
};

class QueryTracer final : public ComputeTracer {
public:
    QueryTracer(const vk::Device& device, const TraceScene& scene, const vk::Buffer& patches)
        : ComputeTracer(device, scene, patches, "query"),
          accel_(device, scene.mesh.positions, scene.mesh.opaqueCount) {
        buffers_.setAccel(accel_.address(), 0);
    }
    bool follows() const override { return true; }
    void update(const SceneChange& change) override {
        buffers_.update(device_, scene_, change);
        accel_ = vk::Accel(device_, scene_.mesh.positions, scene_.mesh.opaqueCount);
        buffers_.setAccel(accel_.address(), 0);
    }

private:
    vk::Accel accel_;
};

class VoxelTracer final : public ComputeTracer {
public:
    VoxelTracer(const vk::Device& device, const TraceScene& scene, const vk::Buffer& patches,
                const VoxelSettings& settings)
        : ComputeTracer(device, scene, patches, "voxel"), map_(device, scene, settings, patches.address()) {
        buffers_.setAccel(map_.address(), 0);
    }

private:
    VoxelMap map_;
};

class PipelineTracer final : public Tracer {
public:
    PipelineTracer(const vk::Device& device, const TraceScene& scene, const vk::Buffer& patches)
        : device_(device), scene_(scene), buffers_(device, scene, patches),
          accel_(device, scene.mesh.positions, scene.mesh.opaqueCount) {
        buffers_.setAccel(accel_.address(), 0);
        // Without masked geometry no any-hit shader stands in the way of the traversal.
        const std::string anyHit = anyHitShader();
        occlusion_ = vk::RayProgram(device, {.raygen = "occlusion_rgen",
                                             .miss = "hit_rmiss",
                                             .closestHit = "hit_rchit",
                                             .anyHit = anyHit,
                                             .constants = {}});
        closest_ = vk::RayProgram(device, {.raygen = "closest_rgen",
                                           .miss = "hit_rmiss",
                                           .closestHit = "hit_rchit",
                                           .anyHit = anyHit,
                                           .constants = {}});
        segments_ = vk::RayProgram(device, {.raygen = "segments_rgen",
                                            .miss = "hit_rmiss",
                                            .closestHit = "hit_rchit",
                                            .anyHit = anyHit,
                                            .constants = {}});
    }

    const char* name() const override { return "rtp"; }
    bool onCpu() const override { return false; }

    void occlusion(VkCommandBuffer cmd, const OcclusionWork& work) override {
        occlusion_.trace(cmd, buffers_.push(work, 0), kChunk, work.unitCount * 2);
    }
    void closest(VkCommandBuffer cmd, const ClosestWork& work) override {
        closest_.trace(cmd, buffers_.push(work), kChunk,
                       work.chunkCount * (work.sampleCount / kSamplesPerInvocation));
    }
    void segments(VkCommandBuffer cmd, const SegmentWork& work) override {
        segments_.trace(cmd, buffers_.push(work), kChunk, work.chunkCount * segmentWords(work));
    }

    void updateSenders(std::span<const uint32_t> patches) override {
        buffers_.updateSenders(device_, scene_, patches);
    }
    bool follows() const override { return true; }
    void update(const SceneChange& change) override {
        buffers_.update(device_, scene_, change);
        accel_ = vk::Accel(device_, scene_.mesh.positions, scene_.mesh.opaqueCount);
        buffers_.setAccel(accel_.address(), 0);
    }
    void retrace(VkCommandBuffer cmd, const RetraceWork& work) override {
        if (!marks_) {
            marks_.emplace(device_);
            retrace_ = vk::RayProgram(device_, {.raygen = "retrace_rgen",
                                                .miss = "hit_rmiss",
                                                .closestHit = "hit_rchit",
                                                .anyHit = anyHitShader(),
                                                .constants = {}});
        }
        marks_->record(cmd, buffers_, work);
        retrace_.trace(cmd, buffers_.push(work), kChunk, retraceGroups(device_));
    }

private:
    const char* anyHitShader() const {
        return scene_.mesh.opaqueCount < scene_.mesh.triangleCount() ? "hit_rahit" : "";
    }

    const vk::Device& device_;
    const TraceScene& scene_;
    SceneBuffers buffers_;
    vk::Accel accel_;
    vk::RayProgram occlusion_, closest_, segments_, retrace_;
    std::optional<RetraceMarks> marks_; // once objects move
};

} // namespace

std::unique_ptr<Tracer> makePipelineTracer(const vk::Device& device, const TraceScene& scene,
                                           const vk::Buffer& patches) {
    return std::make_unique<PipelineTracer>(device, scene, patches);
}
std::unique_ptr<Tracer> makeQueryTracer(const vk::Device& device, const TraceScene& scene,
                                        const vk::Buffer& patches) {
    return std::make_unique<QueryTracer>(device, scene, patches);
}
std::unique_ptr<Tracer> makeBvhTracer(const vk::Device& device, const TraceScene& scene,
                                      const vk::Buffer& patches, MovingBvh tree) {
    return std::make_unique<BvhTracer>(device, scene, patches, std::move(tree));
}

std::unique_ptr<Tracer> makeVoxelTracer(const vk::Device& device, const TraceScene& scene,
                                        const vk::Buffer& patches, const VoxelSettings& settings) {
    return std::make_unique<VoxelTracer>(device, scene, patches, settings);
}

} // namespace relume
