#pragma once

#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// A material and the scene whose textures it reads.
struct PaintedMaterial {
    const Scene& scene;
    const Material& material;
};

/// Tells whether both textures, numbers in their scenes or -1 for none, have the same texels and are read
/// alike.
bool sameTexture(const Scene& a, int x, const Scene& b, int y);

/// Tells whether patches that were made with the one material serve for the other: the same is masked, passes
/// light and has backs, and it shines with the same picture. Colours and the albedo pattern may differ.
bool servesPatches(const PaintedMaterial& before, const PaintedMaterial& after);

/// Tells whether both give their surfaces the same albedo where their base colours are the same.
bool samePattern(const PaintedMaterial& before, const PaintedMaterial& after);

/// Returns 1 for each of these materials that gives its surfaces another albedo pattern than before, when
/// `materials` read the textures of `after`. There are as many as in the former scene.
std::vector<uint8_t> repaintedMaterials(const Scene& before, const Scene& after,
                                        const std::vector<Material>& materials);

} // namespace relume
