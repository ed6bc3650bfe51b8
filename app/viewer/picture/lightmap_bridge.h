#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "app/live/lightmap_exchange.h"
#include "renderer/gl/fence.h"
#include "renderer/gl/pixel_buffer.h"
#include "renderer/gl/shared_texture.h"
#include "renderer/lightmap_texture.h"

namespace relume {

/// The drawing thread's end of the exchange: the newest map as a texture, imported where images are shared
/// and copied else. What is shown stays until a newer map is there. Never waits for the device.
class LightmapBridge {
public:
    explicit LightmapBridge(LightmapExchange& exchange) : exchange_(exchange) {}
    /// Lets go of all sets, after what was drawn from them.
    ~LightmapBridge();
    LightmapBridge(const LightmapBridge&) = delete;
    LightmapBridge& operator=(const LightmapBridge&) = delete;

    /// Once per frame, before it is drawn. True when there is a newer map.
    bool update();
    /// What texture() holds; nullptr: nothing yet.
    const PublishedMap* map() const { return map_ ? &*map_ : nullptr; }
    LightmapTexture texture() const;
    /// Whether slots or sets still wait for the device to be done: update() is to be called again soon.
    bool waiting() const { return !releases_.empty() || !retired_.empty(); }

private:
    struct Set {
        uint32_t number = 0, size = 0;
        bool shared = false;
        std::array<gl::SharedTexture, LightmapExchange::kSlots> images;
        std::array<gl::PixelBuffer, LightmapExchange::kSlots> buffers;
        gl::Texture copy; // of the newest buffer
    };
    /// Something that goes when the device is behind a fence.
    struct Release {
        gl::Fence fence;
        uint32_t set = 0, slot = 0;
    };
    struct Retired {
        gl::Fence fence;
        std::unique_ptr<Set> set;
        uint32_t number = 0; // this set and all before
    };

    void answerOffer();
    std::unique_ptr<Set> import(const MapOffer& offer);
    std::unique_ptr<Set> allocate(const MapOffer& offer);
    void show(const PublishedMap& map);
    void letGo();

    LightmapExchange& exchange_;
    std::unique_ptr<Set> shown_, next_; // next_: accepted, without a map yet
    std::optional<PublishedMap> map_;
    std::vector<Release> releases_;
    std::vector<Retired> retired_;
};

} // namespace relume
