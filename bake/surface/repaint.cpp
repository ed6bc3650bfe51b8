#include "bake/surface/repaint.h"

#include "assets/base/error.h"

namespace relume {
namespace {

bool readsAlike(const Scene& a, const TextureRef& x, const Scene& b, const TextureRef& y) {
    return x.texCoord == y.texCoord && x.transform == y.transform && sameTexture(a, x.texture, b, y.texture);
}

} // namespace

bool sameTexture(const Scene& a, int x, const Scene& b, int y) {
    if (x < 0 || y < 0) return x < 0 && y < 0;
    const Texture &one = a.textures[static_cast<size_t>(x)], &other = b.textures[static_cast<size_t>(y)];
    const Image& was = a.images[static_cast<size_t>(one.image)];
    const Image& is = b.images[static_cast<size_t>(other.image)];
    return one.wrapS == other.wrapS && one.wrapT == other.wrapT && one.nearest == other.nearest &&
           was.width == is.width && was.height == is.height && was.rgba == is.rgba;
}

bool servesPatches(const PaintedMaterial& before, const PaintedMaterial& after) {
    const Material &a = before.material, &b = after.material;
    const bool masked = a.alphaMode == AlphaMode::Mask;
    return a.alphaMode == b.alphaMode && a.alphaCutoff == b.alphaCutoff && a.doubleSided == b.doubleSided &&
           a.transmission == b.transmission && a.pane == b.pane &&
           readsAlike(before.scene, a.emissionTexture, after.scene, b.emissionTexture) &&
           (!masked || readsAlike(before.scene, a.baseColorTexture, after.scene, b.baseColorTexture));
}

bool samePattern(const PaintedMaterial& before, const PaintedMaterial& after) {
    const Material &a = before.material, &b = after.material;
    return a.metallic == b.metallic && a.roughness == b.roughness &&
           readsAlike(before.scene, a.baseColorTexture, after.scene, b.baseColorTexture) &&
           readsAlike(before.scene, a.metallicRoughnessTexture, after.scene, b.metallicRoughnessTexture);
}

std::vector<uint8_t> repaintedMaterials(const Scene& before, const Scene& after,
                                        const std::vector<Material>& materials) {
    ASSERT(materials.size() == before.materials.size());
    std::vector<uint8_t> repainted(materials.size());
    for (size_t i = 0; i < materials.size(); ++i)
        repainted[i] = samePattern({before, before.materials[i]}, {after, materials[i]}) ? 0 : 1;
    return repainted;
}

} // namespace relume
