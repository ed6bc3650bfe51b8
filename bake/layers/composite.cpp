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
double biasShareOf(const Layer& layer) {
    const double bias = std::accumulate(layer.sketch.bias.begin(), layer.sketch.bias.end(), 0.0);
    return layer.indirectVariance > 0.0 ? std::clamp(bias / layer.indirectVariance, 0.0, 1.0) : 0.0;
}

// A layer's indirect error as the composite has it.
struct Weighed {
    const Layer* layer = nullptr;
    double size = 0;        // its root mean square
    glm::dvec3 factor{0.0}; // of the sketch's entries; where there is one

    bool sketched() const { return factor != glm::dvec3(0.0); }
};

Weighed weighedOf(const Layer& layer, double variance) {
    const glm::vec3& weight = layer.source.weight;
    Weighed weighed{&layer, std::sqrt(meanSquareOf(weight) * variance)};
    const double square = layer.sketch.square();
    if (square > 0.0) weighed.factor = glm::dvec3(weight) * std::sqrt(variance / square);
    return weighed;
}

double common(const ErrorSketch& sketch, const glm::dvec3& factor, const std::vector<glm::dvec3>& sum) {
    double product = 0;
    for (size_t k = 0; k < sketch.entries.size(); ++k)
        product += glm::dot(factor * glm::dvec3(sketch.entries[k]), sum[k]);
    return product;
}

// Sets each layer's share of the variance of indirect light. Returns their sum. Where layers are off in
// opposite ways a share is none, but not less.
double shareIndirect(const std::vector<Weighed>& layers, std::vector<Composite::Share>& shares) {
    std::vector<glm::dvec3> sum;
    double alike = 0; // size of those without a sketch
    for (const Weighed& one : layers) {
        if (!one.sketched()) {
            alike += one.size;
            continue;
        }
        const std::vector<glm::vec3>& entries = one.layer->sketch.entries;
        sum.resize(std::max(sum.size(), entries.size()), glm::dvec3(0.0));
        for (size_t k = 0; k < entries.size(); ++k)
            sum[k] += one.factor * glm::dvec3(entries[k]);
    }
    double square = 0, given = 0;
    for (const glm::dvec3& entry : sum)
        square += glm::dot(entry, entry);
    const double size = std::sqrt(square), all = (size + alike) * (size + alike);
    for (size_t i = 0; i < layers.size(); ++i) {
        const Weighed& one = layers[i];
        const double along = one.sketched()
                                 ? (size > 0.0 ? common(one.layer->sketch, one.factor, sum) / size : 0.0)
                                 : one.size;
        shares[i].indirect = std::max(0.0, along) * (size + alike);
        given += shares[i].indirect;
    }
    for (Composite::Share& share : shares)
        share.indirect *= given > 0.0 ? all / given : 0.0;
    return all;
}

} // namespace

Composite compositeOf(std::span<Layer* const> layers) {
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
        indirect.push_back(weighedOf(layer, own.indirect));
        alone += square * own.indirect;
        bias += square * own.indirect * biasShareOf(layer);
    }
    if (!(light > 0.0)) return composite;
    const double together = shareIndirect(indirect, composite.shares);
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
