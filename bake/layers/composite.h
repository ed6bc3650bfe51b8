#pragma once

#include <span>
#include <vector>

#include "bake/layers/layer.h"

namespace relume {

/// How far the weighted sum of layers is off, and what each has to do with it.
struct Composite {
    /// A layer's share; variances are relative to the square of the composite's mean light, and those of all
    /// layers sum up to the square of what samples leave of its error.
    struct Share {
        double direct = 0, indirect = 0; // variance
        double error = 0;                // what the layer would leave alone, later bounces included
    };
    double error = 0;     // relRMSE
    double iteration = 0; // what later bounces still bring, relative to the mean light
    // The square of the sum of layers' indirect errors over the sum of their squares tells what they have in
    // common.
    double alike = 1;
    double bias = 0; // of smoothing, where layers know it chunk by chunk; part of error
    std::vector<Share> shares;
};

/// Tells how far the composite is off locally, and what each layer's variance has to do with it.
struct CompositeLocal {
    /// Holds means over a layer's variance of what that is worth where it is, in any one unit.
    struct Worth {
        double direct = 1, indirect = 1;
    };
    double error = 1;          // 95th percentile
    std::vector<Worth> worths; // of each layer; empty: all are worth the same
};

/// Direct light's errors are independent from layer to layer. Indirect light's go together as their sketches
/// tell, for layers see through the same links; those of a layer without a sketch count as if they had the
/// others' sign everywhere. What later bounces bring is light, and adds up.
/// It keeps in `products`, where there are such, what sketches have in common.
Composite compositeOf(std::span<Layer* const> layers, SketchProducts* products = nullptr);

} // namespace relume
