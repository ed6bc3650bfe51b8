#include "bake/trace/mixed_tracer.h"

#include "bake/vk/commands.h"

namespace relume {
namespace {

class MixedTracer final : public Tracer {
public:
    MixedTracer(const vk::Device& device, std::unique_ptr<Tracer> exact, std::unique_ptr<Tracer> voxels)
        : exact_(std::move(exact)), voxels_(std::move(voxels)),
          name_(std::string(exact_->name()) + "+" + voxels_->name()),
          marched_(device, {.size = 2 * shader::kRayCounters * sizeof(uint32_t), .name = "marched rays"}) {}

    const char* name() const override { return name_.c_str(); }
    bool onCpu() const override { return exact_->onCpu(); }
    bool records() const override { return true; }

    void occlusion(VkCommandBuffer cmd, const OcclusionWork& work) override {
        exact_->occlusion(cmd, work);
        vk::barrier(cmd);
        OcclusionWork rest = work;
        rest.rays = &marched_; // `exact` has counted them
        voxels_->occlusion(cmd, rest);
    }
    void closest(VkCommandBuffer cmd, const ClosestWork& work) override {
        exact_->closest(cmd, work);
        vk::barrier(cmd);
        voxels_->closest(cmd, work);
    }
    void segments(VkCommandBuffer cmd, const SegmentWork& work) override {
        exact_->segments(cmd, work);
        vk::barrier(cmd);
        SegmentWork rest = work;
        rest.rays = &marched_;
        voxels_->segments(cmd, rest);
    }
    void updateSenders(std::span<const uint32_t> patches) override {
        exact_->updateSenders(patches);
        voxels_->updateSenders(patches);
    }

private:
    std::unique_ptr<Tracer> exact_, voxels_;
    std::string name_;
    vk::Buffer marched_;
};

} // namespace

std::unique_ptr<Tracer> makeMixedTracer(const vk::Device& device, std::unique_ptr<Tracer> exact,
                                        std::unique_ptr<Tracer> voxels) {
    return std::make_unique<MixedTracer>(device, std::move(exact), std::move(voxels));
}

} // namespace relume
