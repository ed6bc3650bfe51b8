#include "assets/decode/webp.h"

#include <webp/decode.h>

#include <algorithm>
#include <string_view>

namespace relume {

namespace {

std::optional<WebPBitstreamFeatures> featuresOf(std::span<const uint8_t> bytes) {
    WebPBitstreamFeatures features;
    if (!isWebp(bytes) || WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK)
        return std::nullopt;
    if (features.has_animation || features.width <= 0 || features.height <= 0) return std::nullopt;
    return features;
}

} // namespace

bool isWebp(std::span<const uint8_t> bytes) {
    constexpr std::string_view kContainer = "RIFF", kKind = "WEBP"; // four bytes of size lie between them
    constexpr size_t kKindAt = 8;
    return bytes.size() >= kKindAt + kKind.size() &&
           std::equal(kContainer.begin(), kContainer.end(), bytes.begin()) &&
           std::equal(kKind.begin(), kKind.end(), bytes.begin() + kKindAt);
}

std::optional<WebpSize> webpSize(std::span<const uint8_t> bytes) {
    const std::optional<WebPBitstreamFeatures> features = featuresOf(bytes);
    if (!features) return std::nullopt;
    return WebpSize{static_cast<uint32_t>(features->width), static_cast<uint32_t>(features->height)};
}

std::optional<std::vector<uint8_t>> decodeWebp(std::span<const uint8_t> bytes) {
    const std::optional<WebpSize> size = webpSize(bytes);
    if (!size) return std::nullopt;
    constexpr size_t kChannels = 4;
    std::vector<uint8_t> rgba(kChannels * size->width * size->height);
    const int stride = static_cast<int>(kChannels * size->width);
    if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), rgba.data(), rgba.size(), stride))
        return std::nullopt;
    return rgba;
}

} // namespace relume
