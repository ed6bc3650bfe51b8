#include "app/viewer/picture/lightmap_bridge.h"

#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>

#include <unistd.h>

namespace relume {

LightmapBridge::~LightmapBridge() {
    // Only the end waits: the slots must not go while something is drawn from them.
    gl::Fence all = gl::Fence::insert();
    all.wait();
    const uint32_t last = next_ ? next_->number : shown_ ? shown_->number : 0;
    if (last > 0) exchange_.retire(last);
}

std::unique_ptr<LightmapBridge::Set> LightmapBridge::import(const MapOffer& offer) {
    auto set = std::make_unique<Set>();
    set->number = offer.set;
    set->size = offer.size;
    set->shared = true;
    for (size_t i = 0; i < LightmapExchange::kSlots; ++i) {
        try {
            set->images[i] = gl::SharedTexture({.fd = offer.fds[i],
                                                .memorySize = offer.memorySize,
                                                .width = offer.size,
                                                .height = offer.size,
                                                .name = "shared lightmap"});
        } catch (...) {
            for (size_t k = i + 1; k < LightmapExchange::kSlots; ++k) // the importer closed its own
                if (offer.fds[k] >= 0) close(offer.fds[k]);
            throw;
        }
    }
    return set;
}

std::unique_ptr<LightmapBridge::Set> LightmapBridge::allocate(const MapOffer& offer) {
    auto set = std::make_unique<Set>();
    set->number = offer.set;
    set->size = offer.size;
    set->copy = gl::Texture(
        {.width = offer.size, .height = offer.size, .format = GL_RGBA16F, .name = "copied lightmap"});
    for (gl::PixelBuffer& buffer : set->buffers)
        buffer = gl::PixelBuffer({.width = offer.size, .height = offer.size, .name = "lightmap upload"});
    return set;
}

void LightmapBridge::answerOffer() {
    const std::optional<MapOffer> offer = exchange_.takeOffer();
    if (!offer) return;
    next_.reset(); // never drawn from
    std::array<std::span<std::byte>, LightmapExchange::kSlots> memory;
    try {
        next_ = offer->shared ? import(*offer) : allocate(*offer);
    } catch (const Error& error) {
        if (!offer->shared) { // what is shown stays, and the bake waits for the answer to a smaller offer
            spdlog::error("display: the light is not shown: {}: use a smaller lightmap", error.what());
            return;
        }
        spdlog::warn("display: the images of the bake cannot be shared, they are copied: {}", error.what());
        exchange_.refuse(offer->set);
        return;
    }
    if (!next_->shared)
        std::transform(next_->buffers.begin(), next_->buffers.end(), memory.begin(),
                       [](const gl::PixelBuffer& buffer) { return buffer.bytes(); });
    exchange_.accept(offer->set, memory);
}

void LightmapBridge::show(const PublishedMap& map) {
    const bool first = next_ && next_->number == map.set;
    if (first) {
        if (shown_) retired_.push_back({gl::Fence::insert(), std::move(shown_), next_->number - 1});
        shown_ = std::move(next_);
    }
    ASSERT(shown_ && shown_->number == map.set);
    if (shown_->shared) {
        // All pictures that read the former slot were issued before this fence.
        if (!first && map_) releases_.push_back({gl::Fence::insert(), map_->set, map_->slot});
    } else {
        const gl::PixelBuffer& buffer = shown_->buffers[map.slot];
        const uint32_t begin = first ? 0 : map.changed.first;
        const uint32_t end = first ? shown_->size : std::min(map.changed.end, shown_->size);
        if (begin < end) buffer.uploadRows(shown_->copy.get(), begin, end - begin);
        releases_.push_back({gl::Fence::insert(), map.set, map.slot});
    }
    map_ = map;
}

// Lets go in order, because a fence is signalled no sooner than those before it.
void LightmapBridge::letGo() {
    while (!releases_.empty() && releases_.front().fence.signalled()) {
        exchange_.release(releases_.front().set, releases_.front().slot);
        releases_.erase(releases_.begin());
    }
    while (!retired_.empty() && retired_.front().fence.signalled()) {
        const uint32_t number = retired_.front().number;
        retired_.erase(retired_.begin()); // images go before their memory
        exchange_.retire(number);
    }
}

bool LightmapBridge::update() {
    letGo();
    answerOffer();
    const std::optional<PublishedMap> map = exchange_.take();
    if (!map) return false;
    show(*map);
    return true;
}

LightmapTexture LightmapBridge::texture() const {
    if (!map_) return {};
    LightmapTexture texture;
    texture.texture = shown_->shared ? shown_->images[map_->slot].get() : shown_->copy.get();
    texture.size = shown_->size;
    texture.ambient = map_->ambient;
    texture.unit = map_->unit;
    texture.filled = map_->filled;
    return texture;
}

} // namespace relume
