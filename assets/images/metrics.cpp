#include "assets/images/metrics.h"

#include "assets/base/error.h"
#include "assets/images/flip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace relume {
namespace {

constexpr float kMaskThreshold = 0.5f;

std::string sizeOf(const FloatImage& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height);
}

const std::vector<float>* maskPlane(const NamedImage* mask, const FloatImage& image,
                                    const std::string& name) {
    if (!mask) return nullptr;
    if (mask->image.width != image.width || mask->image.height != image.height)
        throw Error(mask->name + " is " + sizeOf(mask->image) + ", " + name + " is " + sizeOf(image) +
                    ": use a mask of the images' size");
    if (mask->image.planes.empty()) throw Error(mask->name + ": has no channel: use a mask with R");
    for (const char* channel : {"coverage", "R"})
        if (const std::vector<float>* plane = mask->image.find(channel)) return plane;
    return mask->image.planes.data();
}

float displayed(float linear) {
    return std::clamp(linear, 0.0f, 1.0f);
}

// A texel darker than this share of the median light is off relative to that share: otherwise a corner that
// nobody can tell from black would decide how good a map is.
constexpr double kLocalFloor = 0.05;

// Dark places are those that are darker than three quarters of a map.
constexpr double kDarkShare = 0.25;

double ratio(double part, double whole) {
    if (part == 0) return 0;
    return whole == 0 ? std::numeric_limits<double>::infinity() : part / whole;
}

} // namespace

double nearestRank(std::span<const float> values, double share) {
    if (values.empty()) return 0;
    // Without the tolerance 0.95 * 20 would be a little above 19.
    const double rank = std::ceil(share * static_cast<double>(values.size()) * (1.0 - 1e-12));
    const size_t index = static_cast<size_t>(std::max(rank, 1.0)) - 1;
    std::vector<float> sorted(values.begin(), values.end());
    const auto place = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(index, sorted.size() - 1));
    std::nth_element(sorted.begin(), place, sorted.end());
    return *place;
}

ImagePair::Planes ImagePair::planesOf(const NamedImage& named) {
    Planes planes{};
    for (size_t c = 0; c < 3; ++c) {
        const std::string channel(1, "RGB"[c]);
        const std::vector<float>* plane = named.image.find(channel);
        if (!plane)
            throw Error(named.name + ": has no channel " + channel + ": compare images with R, G and B");
        planes[c] = plane->data();
    }
    return planes;
}

void ImagePair::checkFinite(const NamedImage& named, const Planes& planes, const std::vector<bool>& covered) {
    size_t count = 0, first = 0;
    for (size_t i = covered.size(); i-- > 0;) {
        if (!covered[i]) continue;
        if (std::isfinite(planes[0][i]) && std::isfinite(planes[1][i]) && std::isfinite(planes[2][i]))
            continue;
        ++count;
        first = i;
    }
    if (count > 0)
        throw Error(named.name + ": " + std::to_string(count) +
                    " covered texels are NaN or infinite, the first at column " +
                    std::to_string(first % named.image.width) + ", row " +
                    std::to_string(first / named.image.width) + ": make the image again");
}

ImagePair::ImagePair(const NamedImage& a, const NamedImage& b, const NamedImage* mask)
    : width_(a.image.width), height_(a.image.height) {
    if (a.image.width != b.image.width || a.image.height != b.image.height)
        throw Error(a.name + " is " + sizeOf(a.image) + ", " + b.name + " is " + sizeOf(b.image) +
                    ": compare images of one size");
    planesA_ = planesOf(a);
    planesB_ = planesOf(b);
    const std::vector<float>* maskValues = maskPlane(mask, a.image, a.name);
    const std::vector<float>* coverageA = a.image.find("coverage");
    const std::vector<float>* coverageB = b.image.find("coverage");

    covered_.resize(static_cast<size_t>(width_) * height_);
    if (maskValues) hidden_.resize(covered_.size());
    for (size_t i = 0; i < covered_.size(); ++i) {
        const bool inA = !coverageA || (*coverageA)[i] == 1.0f, inB = !coverageB || (*coverageB)[i] == 1.0f;
        const bool shown = !maskValues || (*maskValues)[i] > kMaskThreshold;
        covered_[i] = inA && inB && shown;
        if (maskValues) hidden_[i] = inA && inB && !shown;
        texels_ += covered_[i];
        onlyA_ += inA && !inB;
        onlyB_ += inB && !inA;
        masked_ += inA && inB && !shown;
    }
    if (texels_ == 0 && masked_ > 0)
        throw Error(mask->name + ": lets no covered texel through: it must be above 0.5 where texels count");
    if (texels_ == 0)
        throw Error(a.name + " and " + b.name + ": no texel is covered in both: compare maps of one scene");
    checkFinite(a, planesA_, covered_);
    checkFinite(b, planesB_, covered_);
}

Metrics ImagePair::measure() const {
    Metrics metrics{.texels = texels_, .onlyA = onlyA_, .onlyB = onlyB_, .masked = masked_};
    double squares = 0;
    for (size_t i = 0; i < covered_.size(); ++i) {
        if (!covered_[i]) continue;
        metrics.dfpr += displayedDifference(i);
        for (size_t c = 0; c < 3; ++c) {
            const double va = a(i, c), vb = b(i, c), difference = va - vb;
            squares += difference * difference;
            metrics.bias += difference;
            metrics.meanA += va;
            metrics.meanB += vb;
            metrics.maximum = std::max(metrics.maximum, std::abs(difference));
        }
    }
    const double values = 3.0 * static_cast<double>(texels_);
    metrics.rmse = std::sqrt(squares / values);
    metrics.bias /= values;
    metrics.meanA /= values;
    metrics.meanB /= values;
    metrics.relRmse = ratio(metrics.rmse, metrics.meanB);
    metrics.dfpr /= static_cast<double>(texels_);
    return metrics;
}

std::vector<float> ImagePair::differences() const {
    std::vector<float> map(covered_.size(), 0.0f);
    for (size_t i = 0; i < map.size(); ++i) {
        if (!covered_[i]) continue;
        const double r = a(i, 0) - b(i, 0), g = a(i, 1) - b(i, 1), blue = a(i, 2) - b(i, 2);
        map[i] = static_cast<float>(std::sqrt((r * r + g * g + blue * blue) / 3.0));
    }
    return map;
}

double ImagePair::displayedDifference(size_t texel) const {
    double distance2 = 0;
    for (size_t c = 0; c < 3; ++c) {
        const double step = srgbFromLinear(displayed(a(texel, c))) - srgbFromLinear(displayed(b(texel, c)));
        distance2 += step * step;
    }
    return std::sqrt(distance2);
}

std::vector<float> ImagePair::displayedDifferences() const {
    std::vector<float> map(covered_.size(), 0.0f);
    for (size_t i = 0; i < map.size(); ++i)
        if (covered_[i]) map[i] = static_cast<float>(displayedDifference(i));
    return map;
}

std::vector<float> ImagePair::flipDifferences(double pixelsPerDegree) const {
    FlipInput input{width_, height_, {}, {}, covered_};
    for (size_t i = 0; i < covered_.size(); ++i) {
        // What is not compared may hold anything, NaN too.
        const bool in = covered_[i];
        input.a.push_back(in ? glm::vec3(displayed(a(i, 0)), displayed(a(i, 1)), displayed(a(i, 2)))
                             : glm::vec3(0.0f));
        input.b.push_back(in ? glm::vec3(displayed(b(i, 0)), displayed(b(i, 1)), displayed(b(i, 2)))
                             : glm::vec3(0.0f));
    }
    return flip(input, pixelsPerDegree);
}

double ImagePair::medianOfB() const {
    std::vector<float> light;
    for (size_t i = 0; i < covered_.size(); ++i) {
        if (!covered_[i] && (hidden_.empty() || !hidden_[i])) continue;
        const float mean = (b(i, 0) + b(i, 1) + b(i, 2)) / 3.0f;
        if (std::isfinite(mean)) light.push_back(mean);
    }
    return nearestRank(light, 0.5);
}

std::vector<float> ImagePair::localErrors() const {
    const double floor = kLocalFloor * std::max(medianOfB(), 0.0);
    std::vector<float> map(covered_.size(), 0.0f);
    for (size_t i = 0; i < map.size(); ++i) {
        if (!covered_[i]) continue;
        const double of = (double{b(i, 0)} + b(i, 1) + b(i, 2)) / 3.0;
        const double off = std::abs((double{a(i, 0)} + a(i, 1) + a(i, 2)) / 3.0 - of);
        map[i] = static_cast<float>(ratio(off, std::max(of, floor)));
    }
    return map;
}

LocalPercentiles ImagePair::percentiles(const std::vector<float>& localErrors) const {
    std::vector<float> values;
    values.reserve(texels_);
    for (size_t i = 0; i < localErrors.size(); ++i)
        if (covered_[i]) values.push_back(localErrors[i]);
    return {nearestRank(values, 0.5), nearestRank(values, 0.9), nearestRank(values, 0.95),
            nearestRank(values, 0.99)};
}

double ImagePair::darkBias(const NamedImage* by) const {
    if (by && (by->image.width != width_ || by->image.height != height_))
        throw Error(by->name + " is " + sizeOf(by->image) + ", the images are " + std::to_string(width_) +
                    " x " + std::to_string(height_) + ": what is dark is told by an image of their size");
    const Planes order = by ? planesOf(*by) : planesB_;
    if (by) checkFinite(*by, order, covered_);
    std::vector<std::pair<double, size_t>> texels; // how bright, which
    texels.reserve(texels_);
    for (size_t i = 0; i < covered_.size(); ++i)
        if (covered_[i]) texels.emplace_back(double{order[0][i]} + order[1][i] + order[2][i], i);
    const auto count =
        static_cast<std::ptrdiff_t>(std::max<double>(1.0, kDarkShare * static_cast<double>(texels.size())));
    std::nth_element(texels.begin(), texels.begin() + (count - 1), texels.end());
    std::sort(texels.begin(), texels.begin() + count, // sums in the order of texels
              [](const auto& one, const auto& other) { return one.second < other.second; });
    double sumA = 0, sumB = 0;
    for (const auto& [brightness, i] : std::span(texels).first(static_cast<size_t>(count)))
        for (size_t c = 0; c < 3; ++c) {
            sumA += a(i, c);
            sumB += b(i, c);
        }
    return ratio(sumA - sumB, sumB);
}

double ImagePair::mean(const std::vector<float>& map) const {
    double sum = 0;
    for (size_t i = 0; i < map.size(); ++i)
        if (covered_[i]) sum += map[i];
    return sum / static_cast<double>(texels_);
}

Metrics compareImages(const FloatImage& a, const std::string& nameA, const FloatImage& b,
                      const std::string& nameB) {
    return ImagePair({a, nameA}, {b, nameB}).measure();
}

} // namespace relume
