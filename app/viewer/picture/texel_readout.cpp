#include "app/viewer/picture/texel_readout.h"

#include "app/viewer/picture/picture_labels.h"
#include "app/viewer/state/views.h"
#include "renderer/screen_space.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

constexpr float kRing = 5.0f; // radius [points]

} // namespace

std::string texelErrorText(const glm::vec4& texel, float unit, bool any) {
    if (texel.a < kCoveredTexel) return "no patch";
    if (!any) return "no error is told";
    const float percent = 100.0f * unit * texel.r;
    // Two digits are as many as an estimate from few replicates is good for.
    const int digits =
        percent > 0.0f ? std::max(0, 1 - static_cast<int>(std::floor(std::log10(percent)))) : 0;
    return fmt::format("local error {:.{}f} %", percent, std::min(digits, 3));
}

void TexelReadout::choose(const std::optional<Pick>& pick) {
    if (viewEntries()[picture_.state().view].content != MapContent::Error) return;
    chosen_ = pick && pick->lightmapUv ? pick : std::nullopt;
    flat_ = picture_.state().uv;
    version_ = 0;
    text_.clear();
    follow();
}

bool TexelReadout::showsErrors() const {
    const PublishedMap* map = picture_.map();
    return viewEntries()[picture_.state().view].content == MapContent::Error && map != nullptr &&
           map->content == MapContent::Error;
}

void TexelReadout::follow() {
    if (!chosen_ || !showsErrors()) return;
    const LightmapTexture lightmap = picture_.look().lightmap;
    if (lightmap.version == version_) return;
    version_ = lightmap.version;
    const glm::uvec2 at = glm::min(glm::uvec2(*chosen_->lightmapUv * static_cast<float>(lightmap.size)),
                                   glm::uvec2(lightmap.size - 1));
    const std::string text =
        texelErrorText(readTexel(lightmap, at), lightmap.unit, picture_.map()->high > 0.0f);
    if (text != text_) told_ = fmt::format("{} {}: {}", at.x, at.y, text);
    text_ = text;
}

// Returns the texel's place in the picture [points], or nothing where it is not in it.
std::optional<glm::vec2> TexelReadout::place() const {
    const glm::vec2 size = glm::max(picture_.area().size / picture_.scale(), glm::vec2(1.0f));
    if (picture_.state().uv) return pixelAt(picture_.state().uvWindow, *chosen_->lightmapUv, size);
    if (flat_) return std::nullopt;
    return project({picture_.camera().camera(), size}, chosen_->position);
}

void TexelReadout::draw() const {
    if (!chosen_ || !showsErrors()) return;
    const std::optional<glm::vec2> at = place();
    if (!at) return;
    const float scale = picture_.scale();
    const PictureArea& area = picture_.area();
    const glm::vec2 low = area.corner, high = area.corner + area.size, middle = low + scale * *at;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect({low.x, low.y}, {high.x, high.y});
    const ImU32 dark = ImGui::ColorConvertFloat4ToU32({0.0f, 0.0f, 0.0f, 0.8f});
    const ImU32 light = ImGui::ColorConvertFloat4ToU32({1.0f, 1.0f, 1.0f, 1.0f});
    list.AddCircle({middle.x, middle.y}, kRing * scale, dark, 0, 3.0f * scale);
    list.AddCircle({middle.x, middle.y}, kRing * scale, light, 0, scale);
    drawLabel(middle + scale * glm::vec2(2.5f * kRing, -2.5f * kRing), text_.c_str(), glm::vec4(1.0f));
    list.PopClipRect();
}

} // namespace relume
