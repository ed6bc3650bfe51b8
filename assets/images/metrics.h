#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "assets/images/float_image.h"

namespace relume {

/// Tells how far image a is from the reference b, over R, G and B of the texels that count.
struct Metrics {
    double relRmse = 0; // rmse / mean(b); 0 for equal images; infinite where only b is black
    double rmse = 0;    // sqrt(mean((a - b)^2))
    double dfpr = 0;    // mean euclidean RGB distance after clamp to [0, 1] and sRGB encoding, full scale 1
    double maximum = 0; // max |a - b|
    double bias = 0;    // mean(a - b)
    double meanA = 0, meanB = 0;
    uint64_t texels = 0;           // compared
    uint64_t onlyA = 0, onlyB = 0; // covered in one image only, left out
    uint64_t masked = 0;           // covered in both, left out by the mask
};

/// Returns the value that this share of all values does not exceed, by the nearest rank: the k-th smallest of
/// n, where k is share * n rounded up, and at least 1. The median is that of 0.5, so it is always one of the
/// values. Of none it is 0. share: [0, 1].
double nearestRank(std::span<const float> values, double share);

/// Tells how clean a map is where it is dark, too: percentiles, by the nearest rank, of ImagePair's
/// localErrors() over the texels compared. That of 95 % is called the map's local error.
struct LocalPercentiles {
    double p50 = 0, p90 = 0, p95 = 0, p99 = 0;
};

/// Holds an image and what messages call it.
struct NamedImage {
    const FloatImage& image;
    std::string name;
};

/// Holds two checked images of one size and the texels in which they can be compared: those covered in both,
/// a texel being covered where `coverage` is 1, or everywhere in an image without that channel. With a mask,
/// only those count where its `coverage` (else R, else its first channel) is above 0.5.
class ImagePair {
public:
    /// Throws Error, naming the images, where sizes differ, R, G or B is missing, nothing is left to compare
    /// or a value to be compared is not finite. The images must outlive this.
    ImagePair(const NamedImage& a, const NamedImage& b, const NamedImage* mask = nullptr);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const std::vector<bool>& covered() const { return covered_; }
    float a(size_t texel, size_t channel) const { return planesA_[channel][texel]; }
    float b(size_t texel, size_t channel) const { return planesB_[channel][texel]; }

    /// Returns the metrics. Sums are doubles in texel order.
    Metrics measure() const;

    /// Return the difference of each texel, 0 where nothing is compared: the root of the mean square over the
    /// channels; as displayed (DFPR's summand); as somebody flipping between the pictures sees it (FLIP,
    /// assets/images/flip.h).
    std::vector<float> differences() const;
    std::vector<float> displayedDifferences() const;
    std::vector<float> flipDifferences(double pixelsPerDegree) const;
    /// Returns the local error of each texel, 0 where nothing is compared: |a - b| / max(b, 5 % of b's
    /// median), where a and b are the means of R, G and B. The median is that of all texels covered in both
    /// images, whatever the mask hides, so that a mask changes no texel's error; what is hidden and not
    /// finite is left out. Where half of b or more is black the median is 0 and each texel is measured by
    /// itself: one that is black in b has no error where a is black, too, else an infinite one.
    std::vector<float> localErrors() const;
    /// Returns the percentiles of such a map over the texels compared; infinite ones count.
    LocalPercentiles percentiles(const std::vector<float>& localErrors) const;
    /// Tells whether dark places are too bright (above 0) or too dark: mean(a) / mean(b) - 1 over the quarter
    /// of the texels compared, at least one, in which `by` is darkest, by its mean of R, G and B; texels that
    /// are equally dark count in their order. Infinite where only b is black. Without `by` b itself says what
    /// is dark, and then the quarter holds what its noise made dark: the result is too large. An image of the
    /// same place with other noise is free of that. Throws Error as the constructor does.
    double darkBias(const NamedImage* by = nullptr) const;
    /// Returns the mean of such a map over the texels compared.
    double mean(const std::vector<float>& map) const;

private:
    using Planes = std::array<const float*, 3>;

    static Planes planesOf(const NamedImage& named);
    static void checkFinite(const NamedImage& named, const Planes& planes, const std::vector<bool>& covered);
    double displayedDifference(size_t texel) const;
    double medianOfB() const;

    uint32_t width_ = 0, height_ = 0;
    Planes planesA_ = {}, planesB_ = {};
    std::vector<bool> covered_, hidden_; // hidden_: by the mask, else covered; empty without a mask
    uint64_t texels_ = 0, onlyA_ = 0, onlyB_ = 0, masked_ = 0;
};

/// Returns ImagePair's metrics of two images.
Metrics compareImages(const FloatImage& a, const std::string& nameA, const FloatImage& b,
                      const std::string& nameB);

} // namespace relume
