#include "bake/layers/scene_states.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace relume {
namespace {

// A level of 10,000 objects takes 0.7 MB per state, so that some hundred of its states are known.
constexpr uint64_t kMostBytes = 64u << 20;

std::vector<uint32_t> surfacesOf(const Scene& scene, uint32_t paint) {
    std::vector<uint32_t> words;
    words.reserve(1 + 3 * scene.materials.size());
    words.push_back(paint);
    for (const Material& material : scene.materials) {
        for (int k = 0; k < 3; ++k)
            words.push_back(std::bit_cast<uint32_t>(material.baseColor[k]));
    }
    return words;
}

// Hidden objects stand nowhere.
std::vector<uint32_t> objectsOf(const Scene& scene) {
    std::vector<uint32_t> words;
    words.reserve(17 * scene.instances.size());
    for (const Instance& instance : scene.instances) {
        words.push_back(instance.hidden ? 1 : 0);
        for (int k = 0; k < 16 && !instance.hidden; ++k)
            words.push_back(std::bit_cast<uint32_t>(instance.transform[k / 4][k % 4]));
    }
    return words;
}

} // namespace

uint64_t StateBook::numberOf(std::vector<uint32_t> words) {
    const auto known = std::find_if(entries_.rbegin(), entries_.rend(),
                                    [&](const Entry& entry) { return entry.words == words; });
    if (known != entries_.rend()) return known->number;
    bytes_ += words.size() * sizeof(words[0]);
    entries_.push_back({++last_, std::move(words)});
    for (; bytes_ > kMostBytes && entries_.size() > 1; entries_.pop_front())
        bytes_ -= entries_.front().words.size() * sizeof(entries_.front().words[0]);
    return last_;
}

void SceneStates::note(const Scene& scene) {
    before_ = now_;
    now_ = {surfaces_.numberOf(surfacesOf(scene, paint_)), objects_.numberOf(objectsOf(scene))};
}

} // namespace relume
