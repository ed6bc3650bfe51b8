#include "assets/images/float_image.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace relume {

const std::vector<float>* FloatImage::find(const std::string& channel) const {
    const auto found = std::find(channels.begin(), channels.end(), channel);
    return found == channels.end() ? nullptr : &planes[size_t(found - channels.begin())];
}

std::vector<float>& FloatImage::add(const std::string& channel) {
    ASSERT(!find(channel));
    channels.push_back(channel);
    return planes.emplace_back(size_t(width) * height, 0.0f);
}

namespace {

using SrgbSteps = std::array<float, 255>;

// Returns the least linear value that becomes each byte above 0. Positive floats are in the order of their
// bits, among which these are found by halving.
SrgbSteps findSrgbSteps() {
    SrgbSteps steps{};
    for (size_t k = 0; k < steps.size(); ++k) {
        uint32_t below = 0, there = std::bit_cast<uint32_t>(1.0f);
        while (there - below > 1) {
            const uint32_t middle = below + (there - below) / 2;
            const double encoded = srgbFromLinear(double(std::bit_cast<float>(middle)));
            (std::floor(255.0 * encoded + 0.5) > double(k) ? there : below) = middle;
        }
        steps[k] = std::bit_cast<float>(there);
    }
    return steps;
}

} // namespace

uint8_t srgbByte(float linear) {
    static const SrgbSteps steps = findSrgbSteps();
    if (!(linear > 0.0f)) return 0; // NaN, too
    return uint8_t(std::upper_bound(steps.begin(), steps.end(), linear) - steps.begin());
}

double srgbFromLinear(double linear) {
    if (linear < 0) return -srgbFromLinear(-linear);
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linearFromSrgb(double encoded) {
    if (encoded < 0) return -linearFromSrgb(-encoded);
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

} // namespace relume
