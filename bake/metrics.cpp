#include "bake/metrics.h"

#include "assets/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace relume {
namespace {

using Planes = std::array<const float*, 3>;

Planes colourPlanes(const FloatImage& image, const std::string& name) {
    Planes planes{};
    for (size_t c = 0; c < 3; ++c) {
        const std::string channel(1, "RGB"[c]);
        const std::vector<float>* plane = image.find(channel);
        if (!plane) throw Error(name + ": has no channel " + channel + ": compare images with R, G and B");
        planes[c] = plane->data();
    }
    return planes;
}

void checkFinite(const FloatImage& image, const std::string& name, const Planes& planes,
                 const std::vector<bool>& covered) {
    size_t count = 0, first = 0;
    for (size_t i = covered.size(); i-- > 0;) {
        if (!covered[i]) continue;
        if (std::isfinite(planes[0][i]) && std::isfinite(planes[1][i]) && std::isfinite(planes[2][i]))
            continue;
        ++count;
        first = i;
    }
    if (count > 0)
        throw Error(name + ": " + std::to_string(count) +
                    " covered texels are NaN or infinite, the first at column " +
                    std::to_string(first % image.width) + ", row " + std::to_string(first / image.width) +
                    ": make the image again");
}

std::string sizeOf(const FloatImage& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height);
}

double encoded(float linear) {
    return srgbFromLinear(std::clamp(double(linear), 0.0, 1.0));
}

double ratio(double part, double whole) {
    if (part == 0) return 0;
    return whole == 0 ? std::numeric_limits<double>::infinity() : part / whole;
}

} // namespace

Metrics compareImages(const FloatImage& a, const std::string& nameA, const FloatImage& b,
                      const std::string& nameB) {
    if (a.width != b.width || a.height != b.height)
        throw Error(nameA + " is " + sizeOf(a) + ", " + nameB + " is " + sizeOf(b) +
                    ": compare images of one size");
    const Planes planesA = colourPlanes(a, nameA), planesB = colourPlanes(b, nameB);
    const std::vector<float>* coverageA = a.find("coverage");
    const std::vector<float>* coverageB = b.find("coverage");

    Metrics metrics;
    std::vector<bool> covered(size_t(a.width) * a.height);
    for (size_t i = 0; i < covered.size(); ++i) {
        const bool inA = !coverageA || (*coverageA)[i] == 1.0f, inB = !coverageB || (*coverageB)[i] == 1.0f;
        covered[i] = inA && inB;
        metrics.texels += inA && inB;
        metrics.onlyA += inA && !inB;
        metrics.onlyB += inB && !inA;
    }
    if (metrics.texels == 0)
        throw Error(nameA + " and " + nameB + ": no texel is covered in both: compare maps of one scene");
    checkFinite(a, nameA, planesA, covered);
    checkFinite(b, nameB, planesB, covered);

    double squares = 0, shown = 0;
    for (size_t i = 0; i < covered.size(); ++i) {
        if (!covered[i]) continue;
        double distance2 = 0;
        for (size_t c = 0; c < 3; ++c) {
            const double va = planesA[c][i], vb = planesB[c][i], difference = va - vb;
            squares += difference * difference;
            metrics.bias += difference;
            metrics.meanA += va;
            metrics.meanB += vb;
            metrics.maximum = std::max(metrics.maximum, std::abs(difference));
            const double step = encoded(planesA[c][i]) - encoded(planesB[c][i]);
            distance2 += step * step;
        }
        shown += std::sqrt(distance2);
    }
    const double values = 3.0 * double(metrics.texels);
    metrics.rmse = std::sqrt(squares / values);
    metrics.bias /= values;
    metrics.meanA /= values;
    metrics.meanB /= values;
    metrics.relRmse = ratio(metrics.rmse, metrics.meanB);
    metrics.dfpr = shown / double(metrics.texels);
    return metrics;
}

} // namespace relume
