#include "assets/images/float_image.h"

#include "assets/base/error.h"

#include <algorithm>
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

double srgbFromLinear(double linear) {
    if (linear < 0) return -srgbFromLinear(-linear);
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linearFromSrgb(double encoded) {
    if (encoded < 0) return -linearFromSrgb(-encoded);
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

} // namespace relume
