#include "app/text/frame_names.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace relume {

bool isFrameName(const std::string& name) {
    constexpr std::string_view kBefore = "frame_", kAfter = ".png";
    constexpr size_t kLeastDigits = 4;
    if (!name.starts_with(kBefore) || !name.ends_with(kAfter)) return false;
    if (name.size() < kBefore.size() + kLeastDigits + kAfter.size()) return false;
    return std::all_of(name.begin() + kBefore.size(), name.end() - kAfter.size(),
                       [](unsigned char letter) { return std::isdigit(letter) != 0; });
}

bool isVideo(const std::string& path) {
    return path.ends_with(".mp4");
}

} // namespace relume
