#pragma once

#include "assets/float_image.h"

namespace relume {

/// How far image a is from the reference b, over R, G and B of the texels covered in both.
struct Metrics {
    double relRmse = 0; // rmse / mean(b); 0 for equal images; infinite where only b is black
    double rmse = 0;    // sqrt(mean((a - b)^2))
    double dfpr = 0;    // mean euclidean RGB distance after clamp to [0, 1] and sRGB encoding, full scale 1
    double maximum = 0; // max |a - b|
    double bias = 0;    // mean(a - b)
    double meanA = 0, meanB = 0;
    uint64_t texels = 0;           // compared
    uint64_t onlyA = 0, onlyB = 0; // covered in one image only, left out
};

/// A texel is covered where `coverage` is 1, or everywhere in an image without that channel. Sums are doubles
/// in texel order. Throws Error, naming the images, when sizes differ, R, G or B is missing, nothing is
/// covered in both or a covered value is not finite.
Metrics compareImages(const FloatImage& a, const std::string& nameA, const FloatImage& b,
                      const std::string& nameB);

} // namespace relume
