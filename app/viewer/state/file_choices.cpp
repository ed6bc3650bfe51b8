#include "app/viewer/state/file_choices.h"

#include <algorithm>

namespace relume {
namespace {

// Returns what a scene is chosen by: its name, or its number where another one before it has that name.
std::string keyOfScene(const std::vector<std::string>& names, size_t index) {
    const auto end = names.begin() + static_cast<std::ptrdiff_t>(index);
    return std::find(names.begin(), end, names[index]) == end ? names[index] : std::to_string(index);
}

} // namespace

std::vector<FileChoice> sceneChoices(const std::vector<std::string>& names, int shown,
                                     const GltfChoice& now) {
    std::vector<FileChoice> choices;
    if (names.size() < 2) return choices;
    GltfChoice choice = now;
    for (size_t i = 0; i < names.size(); ++i) {
        choice.scene = keyOfScene(names, i);
        choices.push_back({names[i], choice, static_cast<int>(i) == shown});
    }
    return choices;
}

std::vector<FileChoice> variantChoices(const std::vector<std::string>& names, const GltfChoice& now) {
    std::vector<FileChoice> choices;
    if (names.empty()) return choices;
    GltfChoice choice = now;
    choice.variant.clear();
    choices.push_back({"The file's own materials", choice, now.variant.empty()});
    for (const std::string& name : names) {
        choice.variant = name;
        choices.push_back({name, choice, now.variant == name});
    }
    return choices;
}

} // namespace relume
