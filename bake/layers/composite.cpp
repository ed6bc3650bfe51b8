#include "bake/layers/composite.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

double meanOf(const glm::vec3& weight) {
    return (double{weight.r} + weight.g + weight.b) / 3.0;
}

double meanSquareOf(const glm::vec3& weight) {
    return glm::dot(glm::dvec3(weight), glm::dvec3(weight)) / 3.0;
}

// A layer's variances for a unit of its weight, in the unit of its light squared.
struct Variances {
    double direct = 0, indirect = 0;
};

Variances variancesOf(const Layer& layer) {
    const double sampled = layer.error * layer.error - layer.iterationError * layer.iterationError;
    const double all = layer.directVariance + layer.indirectVariance;
    if (!(sampled > 0.0) || !(all > 0.0)) return {};
    const double unit = sampled * layer.light * layer.light / all;
    return {unit * layer.directVariance, unit * layer.indirectVariance};
}

// Returns the share of a layer's indirect variance that is bias of smoothing.
double biasShareOf(const Layer& layer, SketchProducts& products) {
    return layer.indirectVariance > 0.0
               ? std::clamp(products.biasOf(layer.sketch) / layer.indirectVariance, 0.0, 1.0)
               : 0.0;
}

// A layer's indirect error as the composite has it.
struct Weighed {
    const Layer* layer = nullptr;
    double size = 0;        // its root mean square
    glm::dvec3 factor{0.0}; // of the sketch's entries; where there is one

    bool sketched() const { return factor != glm::dvec3(0.0); }
};

double sumOf(const glm::dvec3& v) {
    return v.x + v.y + v.z;
}

Weighed weighedOf(const Layer& layer, double variance, SketchProducts& products) {
    const glm::vec3& weight = layer.source.weight;
    Weighed weighed{&layer, std::sqrt(meanSquareOf(weight) * variance)};
    const double square = sumOf(products.of(layer.sketch, layer.sketch));
    if (square > 0.0) weighed.factor = glm::dvec3(weight) * std::sqrt(variance / square);
    return weighed;
}

// Products of all pairs are kept of so many layers at most. Of more they would be made for longer than
// summing up all sketches each time takes.
constexpr size_t kMostPairwise = 64;

// Returns what each layer's error has in common with the sum of all that have a sketch.
std::vector<double> commonByPairs(const std::vector<Weighed>& layers, SketchProducts& products) {
    std::vector<double> common(layers.size(), 0.0);
    for (size_t i = 0; i < layers.size(); ++i)
        for (size_t j = 0; j <= i; ++j) {
            const glm::dvec3 factor = layers[i].factor * layers[j].factor;
            if (factor == glm::dvec3(0.0)) continue;
            const double both = sumOf(factor * products.of(layers[i].layer->sketch, layers[j].layer->sketch));
            common[i] += both;
            if (j != i) common[j] += both;
        }
    return common;
}

std::vector<double> commonBySum(const std::vector<Weighed>& layers) {
    std::vector<glm::dvec3> sum;
    for (const Weighed& one : layers) {
        const std::vector<glm::vec3>& entries = one.layer->sketch.entries;
        if (!one.sketched()) continue;
        sum.resize(std::max(sum.size(), entries.size()), glm::dvec3(0.0));
        for (size_t k = 0; k < entries.size(); ++k)
            sum[k] += one.factor * glm::dvec3(entries[k]);
    }
    std::vector<double> common(layers.size(), 0.0);
    for (size_t i = 0; i < layers.size(); ++i) {
        const std::vector<glm::vec3>& entries = layers[i].layer->sketch.entries;
        for (size_t k = 0; layers[i].sketched() && k < entries.size(); ++k)
            common[i] += glm::dot(layers[i].factor * glm::dvec3(entries[k]), sum[k]);
    }
    return common;
}

// Sets each layer's share of the variance of indirect light. Returns their sum. Where layers are off in
// opposite ways a share is none, but not less.
double shareIndirect(const std::vector<Weighed>& layers, SketchProducts& products,
                     std::vector<Composite::Share>& shares) {
    const std::vector<double> common =
        layers.size() <= kMostPairwise ? commonByPairs(layers, products) : commonBySum(layers);
    double alike = 0; // size of those without a sketch
    for (const Weighed& one : layers)
        if (!one.sketched()) alike += one.size;
    const double square = std::accumulate(common.begin(), common.end(), 0.0);
    const double size = std::sqrt(std::max(0.0, square)), all = (size + alike) * (size + alike);
    double given = 0;
    for (size_t i = 0; i < layers.size(); ++i) {
        const double along = layers[i].sketched() ? (size > 0.0 ? common[i] / size : 0.0) : layers[i].size;
        shares[i].indirect = std::max(0.0, along) * (size + alike);
        given += shares[i].indirect;
    }
    for (Composite::Share& share : shares)
        share.indirect *= given > 0.0 ? all / given : 0.0;
    return all;
}

} // namespace

Composite compositeOf(std::span<Layer* const> layers, SketchProducts* kept) {
    SketchProducts ofOne;
    SketchProducts& products = kept != nullptr ? *kept : ofOne;
    Composite composite;
    composite.shares.resize(layers.size());
    std::vector<Weighed> indirect;
    double light = 0, variance = 0, later = 0, alone = 0, bias = 0;
    for (size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = *layers[i];
        const Variances own = variancesOf(layer);
        const double weight = meanOf(layer.source.weight), square = meanSquareOf(layer.source.weight);
        light += weight * layer.light;
        later += weight * layer.light * layer.iterationError;
        composite.shares[i].direct = square * own.direct;
        composite.shares[i].error = weight * layer.light * layer.error;
        variance += composite.shares[i].direct;
        indirect.push_back(weighedOf(layer, own.indirect, products));
        alone += square * own.indirect;
        bias += square * own.indirect * biasShareOf(layer, products);
    }
    if (!(light > 0.0)) return composite;
    const double together = shareIndirect(indirect, products, composite.shares);
    variance += together;
    if (alone > 0.0) composite.alike = together / alone;
    composite.bias = std::sqrt(composite.alike * bias) / light;
    for (Composite::Share& share : composite.shares) {
        share.direct /= light * light;
        share.indirect /= light * light;
        share.error /= light;
    }
    composite.iteration = later / light;
    composite.error = std::sqrt(variance / (light * light) + composite.iteration * composite.iteration);
    return composite;
}

} // namespace relume
