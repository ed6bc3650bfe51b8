#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/live/bake_desk.h"
#include "bake/show/publisher.h"

namespace relume {

/// Decides whether maps go to OpenGL as shared images. The obstacle tells why they cannot be shared; "": they
/// can. Throws Error where they must be and cannot.
struct DisplayChoice {
    bool shared = false;
    std::string text; // with the reason: "shared (OpenGL and Vulkan use one device)"
};
DisplayChoice chooseDisplay(DisplayMode mode, const std::string& obstacle);
/// Decides it again once OpenGL did not take the images. Throws Error where they must be shared.
DisplayChoice chooseAfterRefusal(DisplayMode mode);

/// The slots of the exchange that maps are written to: images that OpenGL imports, or plain memory. A set of
/// slots has one size; former sets stay until nobody draws with them. Only the bake thread uses it.
class MapSlots {
public:
    struct Desc {
        DisplayMode display = DisplayMode::Auto;
        DisplayHost host;
    };
    /// Decides how images reach OpenGL. Throws Error when they must be shared and cannot be.
    MapSlots(const vk::Device& device, LightmapExchange& exchange, const Desc& desc);

    /// Tells what was chosen, with the reason.
    const std::string& choice() const { return display_.text; }
    /// Claims a slot for maps of this size [texels], which replaces a set of another size. Returns nothing
    /// where there is none yet.
    std::optional<uint32_t> claim(uint32_t size);
    /// Writes what the publisher holds to a slot that was claimed, and hands it over with what is told of it.
    void publish(Publisher& publisher, uint32_t slot, PublishedMap map);
    /// Destroys images that nobody draws with any more.
    void takeBackFormer();

private:
    using Images = std::array<vk::SharedImage, Publisher::kSlots>;
    /// Images that the drawing thread may still use.
    struct Former {
        uint32_t set = 0;
        Images images;
    };
    void offer();

    const vk::Device& device_;
    LightmapExchange& exchange_;
    DisplayMode mode_;
    DisplayChoice display_;
    uint32_t set_ = 0, size_ = 0; // [texels]
    Images images_;               // of the set, where it is shared
    std::vector<Former> former_;
    const Publisher* writer_ = nullptr; // of the newest map in this set
};

} // namespace relume
