#include "bake/baker/host_room.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string>

namespace relume {
namespace {

// Texels as the CIT pass leaves them (TextureGroup), of which each image is read back through a copy.
constexpr uint64_t kTexelBytes = 4 * sizeof(glm::vec4) + sizeof(uint32_t);
constexpr uint64_t kReadBackBytes = sizeof(glm::vec4);
// Whose patch a texel is, and the patches with all that belongs to them (PatchSet).
constexpr uint64_t kTableBytes = sizeof(uint32_t);
constexpr uint64_t kPatchBytes = sizeof(shader::Patch) + sizeof(shader::PatchEdges) +
                                 sizeof(shader::PatchCover) + 4 * sizeof(glm::vec4) + 4 * sizeof(uint32_t);
// The light that is read back, and the lightmap and the map of errors that are made of it.
constexpr uint64_t kResultBytes = 3 * sizeof(glm::vec4);

} // namespace

uint64_t hostNeeds(const BakeSettings& settings, const SceneExtent& scene, uint64_t spilled) {
    const uint64_t sheet = scene.pages.sheetOf(settings.size), texels = sheet * sheet;
    const uint64_t patches = uint64_t{scene.pages.count} * settings.size * settings.size;
    const uint64_t read = texels * (kTexelBytes + kReadBackBytes);
    const uint64_t made = texels * (kTexelBytes + kTableBytes) + patches * kPatchBytes;
    const uint64_t baked =
        spilled > 0 ? texels * (kTableBytes + kResultBytes) + patches * kPatchBytes + spilled : 0;
    return std::max({read, made, baked});
}

std::optional<uint64_t> availableIn(std::string_view memInfo) {
    constexpr std::string_view kName = "MemAvailable:";
    size_t at = memInfo.find(kName);
    if (at == std::string_view::npos) return std::nullopt;
    at = memInfo.find_first_not_of(' ', at + kName.size());
    if (at == std::string_view::npos) return std::nullopt;
    uint64_t kibibytes = 0;
    const auto [end, error] =
        std::from_chars(memInfo.data() + at, memInfo.data() + memInfo.size(), kibibytes);
    const auto rest = static_cast<size_t>(end - memInfo.data());
    if (error != std::errc() || !memInfo.substr(rest).starts_with(" kB")) return std::nullopt;
    return kibibytes << 10;
}

std::optional<uint64_t> freeHostMemory() {
    std::ifstream file("/proc/meminfo");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return availableIn(text);
}

} // namespace relume
