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

/// The drawing thread's end of the exchange. It has the newest map as a texture, imported where images are
/// shared and copied otherwise. What is shown stays until a newer map is there. Only the destructor waits for
/// the device.
class LightmapBridge {
public:
    explicit LightmapBridge(LightmapExchange& exchange) : exchange_(exchange) {}
    /// Waits for what was drawn from the sets, then lets go of all of them.
    ~LightmapBridge();
    LightmapBridge(const LightmapBridge&) = delete;
    LightmapBridge& operator=(const LightmapBridge&) = delete;

    /// Takes the newest map; call it once per frame, before drawing. Returns whether there is a newer one.
    bool update();
    /// Returns the map that texture() holds, or nullptr where there is none yet.
    const PublishedMap* map() const { return map_ ? &*map_ : nullptr; }
    LightmapTexture texture() const;
    /// Tells whether slots or sets still wait for the device to be done: call update() again soon.
    bool waiting() const { return !releases_.empty() || !retired_.empty(); }

private:
    struct Set {
        uint32_t number = 0, size = 0;
        bool shared = false;
        std::array<gl::SharedTexture, LightmapExchange::kSlots> images;
        std::array<gl::PixelBuffer, LightmapExchange::kSlots> buffers;
        gl::Texture copy; // of the newest buffer
    };
    /// A slot that is released when the device has passed a fence.
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
