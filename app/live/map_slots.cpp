#include "app/live/map_slots.h"

#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// Returns why images cannot be shared, or "".
std::string obstacleToSharing(const vk::Device& device, const DisplayHost& host) {
    constexpr uint32_t kProbe = 64; // [texels]; whether images can be shared does not depend on it
    const auto& uuids = host.deviceUuids;
    if (!host.memoryObjects) return "OpenGL has no GL_EXT_memory_object_fd";
    if (std::find(uuids.begin(), uuids.end(), device.info().uuid) == uuids.end())
        return "OpenGL draws on another device";
    if (!vk::SharedImage::possible(device, kProbe, kProbe)) return "Vulkan cannot export images";
    return "";
}

RowRange rowsOf(const std::vector<TexelArea>& areas) {
    RowRange rows;
    for (const TexelArea& area : areas)
        rows.add({area.y, area.y + area.height});
    return rows;
}

} // namespace

DisplayChoice chooseDisplay(DisplayMode mode, const std::string& obstacle) {
    if (mode == DisplayMode::Shared && !obstacle.empty())
        throw Error("--display shared: " + obstacle + ": use --display copied");
    if (mode == DisplayMode::Copied) return {.shared = false, .text = "copied (as asked for)"};
    if (!obstacle.empty()) return {.shared = false, .text = "copied (" + obstacle + ")"};
    return {.shared = true, .text = "shared (OpenGL and Vulkan use one device)"};
}

DisplayChoice chooseAfterRefusal(DisplayMode mode) {
    if (mode == DisplayMode::Shared)
        throw Error("--display shared: OpenGL did not take the images: use --display copied");
    return {.shared = false, .text = "copied (OpenGL did not take the images)"};
}

MapSlots::MapSlots(const vk::Device& device, LightmapExchange& exchange, const Desc& desc)
    : device_(device), exchange_(exchange), mode_(desc.display),
      display_(chooseDisplay(desc.display, obstacleToSharing(device, desc.host))) {}

std::optional<uint32_t> MapSlots::claim(uint32_t size) {
    if (display_.shared && exchange_.refused()) {
        display_ = chooseAfterRefusal(mode_);
        spdlog::warn("display: {}", display_.text);
        size_ = 0;
    }
    if (size != size_) {
        size_ = size;
        offer();
    }
    return exchange_.claim();
}

void MapSlots::offer() {
    if (images_[0].handle() != VK_NULL_HANDLE) former_.push_back({set_, std::move(images_)});
    images_ = {};
    MapOffer offer{.set = ++set_, .size = size_, .shared = display_.shared};
    if (display_.shared) {
        for (uint32_t slot = 0; slot < Publisher::kSlots; ++slot) {
            images_[slot] =
                vk::SharedImage(device_, {.width = size_, .height = size_, .name = "shared lightmap"});
            offer.fds[slot] = images_[slot].exportFd();
        }
        offer.memorySize = images_[0].memorySize();
    }
    exchange_.offer(offer);
    writer_ = nullptr;
}

void MapSlots::publish(Publisher& publisher, uint32_t slot, PublishedMap map) {
    // The slots may hold what another publisher wrote, which this one does not know, or nothing yet.
    if (writer_ != &publisher) publisher.forget();
    writer_ = &publisher;
    const std::vector<TexelArea> areas = display_.shared ? publisher.publish(images_[slot], slot)
                                                         : publisher.publish(exchange_.memory(slot), slot);
    map.slot = slot;
    map.set = set_;
    map.changed = rowsOf(areas);
    exchange_.publish(map);
}

void MapSlots::takeBackFormer() {
    std::erase_if(former_, [&](const Former& former) { return exchange_.retiredBefore(former.set + 1); });
}

} // namespace relume
