#include "bake/pairs/pair_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "assets/base/error.h"
#include "bake/base/finite_light.h"
#include "bake/base/series.h"

namespace relume {
namespace {

// One thread sums up the change of so many patches at a time.
constexpr uint32_t kMeasured = 1u << 16;
// Light that spreads through a level may change more for some passes, but not for so many, and not by so
// much of the mean.
constexpr uint32_t kMostGrowing = 12;
constexpr double kLeastGrowth = 1e-3;

} // namespace

PairLight::PairLight(const PatchSet& patches, std::vector<glm::vec4> start, bool dark)
    : patches_(patches), dark_(dark), last_(std::move(start)), before_(last_) {}

std::optional<double> PairLight::take(WorkerPool& pool,
                                      const std::function<void(std::vector<glm::vec4>&)>& read) {
    std::swap(last_, before_);
    read(last_);
    return measure(pool);
}

std::optional<double> PairLight::measure(WorkerPool& pool) {
    const uint32_t pieces = (patches_.count + kMeasured - 1) / kMeasured;
    std::vector<Sums> parts(pieces);
    pool.run(pieces, [&](uint32_t k) { parts[k] = changeOf(k * kMeasured); });
    Sums all;
    for (const Sums& part : parts) {
        all.squares += part.squares;
        all.light += part.light;
        all.count += part.count;
    }
    const double change = all.count > 0 ? std::sqrt(all.squares / static_cast<double>(all.count)) : 0.0;
    const double mean = all.count > 0 ? all.light / static_cast<double>(all.count) : 0.0;
    requireFiniteLight(mean, change);
    if (dark_) requireDecay(change, mean);
    const std::optional<SeriesRest> rest = seriesRest(state_.lastChange, change, mean);
    if (rest) left_ = static_cast<float>(rest->ratio < 1.0 ? rest->ratio / (1.0 - rest->ratio) : 1.0);
    state_.lastChange = change;
    const bool first = state_.convergence.mean < 0;
    if (first && dark_) state_.convergence.add(0.0);
    state_.convergence.add(mean);
    return rest ? std::optional(rest->error) : std::nullopt;
}

// Surfaces reflect less than all, so in the end each bounce brings less than the one before. It does not
// where form factors of senders sum to more than 1.
void PairLight::requireDecay(double change, double mean) {
    const bool grows = state_.lastChange > 0 && change >= state_.lastChange && change > kLeastGrowth * mean;
    growing_ = grows ? growing_ + 1 : 0;
    if (growing_ >= kMostGrowing)
        throw Error(
            "the light grows from pass to pass, as the method's senders are too coarse for what lies close "
            "to them here: give a smaller --window, or --method hybrid");
}

// Sums up the change of the patches from `first` on.
PairLight::Sums PairLight::changeOf(uint32_t first) const {
    Sums sums;
    for (uint32_t i = first; i < std::min(first + kMeasured, patches_.count); ++i) {
        const uint32_t flags = patches_.scene.patches[i].flags;
        if (!shader::patchIsShown(flags)) continue;
        const glm::dvec3 change = glm::dvec3(last_[i]) - glm::dvec3(before_[i]);
        sums.squares += glm::dot(change, change);
        sums.light += double{last_[i].r} + last_[i].g + last_[i].b;
        sums.count += 3;
    }
    return sums;
}

std::vector<float> PairLight::errors() const {
    std::vector<float> errors(left_ ? last_.size() : 0);
    for (size_t i = 0; i < errors.size(); ++i)
        errors[i] = *left_ * glm::length(glm::vec3(last_[i] - before_[i])) / std::sqrt(3.0f);
    return errors;
}

void PairLight::restore(const State& state, std::vector<glm::vec4> light) {
    state_ = state;
    last_ = std::move(light);
    before_ = last_;
    left_.reset();
}

} // namespace relume
