#pragma once

#include <vector>

#include "assets/atlas/unwrap_memory.h"
#include "assets/model/scene.h"

namespace relume {

/// An instance that gets a place in the atlas.
struct UnwrapObject {
    size_t instance = 0, shape = 0;
    double scale = 1.0; // of the instance against its shape
};

/// Holds what of a scene goes into an atlas.
struct UnwrapParts {
    std::vector<UnwrapShape> shapes;
    std::vector<UnwrapObject> objects;
    std::vector<size_t> meshOf; // per shape
};

/// Finds the instances of the meshes that are chosen to be cut, and of those whose UVs are kept (`set` 0 or 1
/// instead of -1). Shapes come without charts.
UnwrapParts collectParts(const Scene& scene, const std::vector<bool>& chosen, const std::vector<int>& set);

/// Returns the area of the mesh in the proportions of the shape.
double areaOf(const Mesh& mesh, const UnwrapShape& shape);

/// Cuts the mesh into charts of the shape, or makes the one of its kept UVs.
void cutShape(const Mesh& mesh, int set, UnwrapShape& shape, WorkerPool& pool);
/// Cuts it into single triangles, which cannot overlap.
void cutShapeUp(const Mesh& mesh, UnwrapShape& shape);

/// Tells whether two shapes have charts alike: those of texels that are some twice as large are good enough.
bool sameShape(const UnwrapShape& a, const UnwrapShape& b);

} // namespace relume
