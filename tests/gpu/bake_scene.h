#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "assets/images/float_image.h"
#include "assets/model/scene.h"
#include "bake/baker/baker.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"

namespace relume {

inline const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// Describes the texels of a lightmap that one surface of a test scene covers.
struct TexelRect {
    uint32_t x = 0, y = 0, width = 0, height = 0;
};

/// Builds a scene of a few surfaces, each an instance with a chart on whole texels of one lightmap. Albedo
/// and emission are grey. A surface's TEXCOORD_0 runs from 0 to 1 over it.
class SceneMaker {
public:
    explicit SceneMaker(uint32_t size) : size_(size) {} // lightmap edge [texels]

    /// Adds a rough dielectric of this albedo and emission [cd/m^2]. Returns its index.
    int material(float albedo, float emission = 0.0f);
    int material(const Material& material);
    /// Adds a texture of alpha per texel, row 0 first, looked up without interpolation. Returns its index.
    int alphaTexture(uint32_t width, uint32_t height, const std::vector<uint8_t>& alpha);

    /// Adds the parallelogram corner + s u + t v, s and t in [0, 1], front along u x v. Texel columns run
    /// along u.
    TexelRect quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v, int material, glm::uvec2 texels);
    /// Adds the same without lightmap UVs: it only blocks light.
    void blocker(glm::vec3 corner, glm::vec3 u, glm::vec3 v, int material);
    /// Adds a polygon of many sides in place of the ellipse of half axes u and v, in a square chart. Its area
    /// is within 1e-4 of the ellipse's.
    TexelRect disc(glm::vec3 centre, glm::vec3 u, glm::vec3 v, int material, uint32_t texels);
    /// Adds the walls of the box with edges u, v and w (right-handed) as seen from inside: those at the start
    /// of u, v, w, then those at the end. Each has one material and number of texels; texels.x goes along the
    /// first of the wall's two edges in cyclic order u, v, w.
    std::array<TexelRect, 6> box(glm::vec3 corner, const std::array<glm::vec3, 3>& edges,
                                 const std::array<int, 6>& materials,
                                 const std::array<glm::uvec2, 6>& texels);
    std::array<TexelRect, 6> box(glm::vec3 corner, const std::array<glm::vec3, 3>& edges, int material,
                                 uint32_t texels);
    /// Adds a sphere seen from inside, as six faces of a cube blown up, each cut into texels x texels cells.
    std::array<TexelRect, 6> sphere(glm::vec3 centre, float radius, const std::array<int, 6>& materials,
                                    uint32_t texels);

    Instance& lastInstance() { return scene_.instances.back(); }
    uint32_t size() const { return size_; }
    const Scene& scene() const { return scene_; }

private:
    TexelRect place(glm::uvec2 texels);
    glm::vec2 uvAt(const TexelRect& rect, glm::dvec2 st) const;
    void add(Primitive primitive);

    uint32_t size_;
    uint32_t shelfX_ = 0, shelfY_ = 0, shelfHeight_ = 0; // [texels], where the next chart goes
    Scene scene_;
};

struct BakeDesc {
    uint32_t size = 64; // lightmap edge [texels]
    TracerKind tracer = TracerKind::Auto;
    uint32_t passes = 1;
    double error = 0;
    double localError = 0;
    bool allOver = true;   // samples start all over their texels
    bool perChunk = false; // samples go where light is still off
    double batchMs = 20;
    Method method = Method::Pure;
    uint32_t samples = 0; // link methods: directions per patch
    bool smooth = false;
    DirectionSet directions = DirectionSet::Sobol;
    Rotation rotation = Rotation::Patch;
    uint32_t indirectScale = 1;
    bool footprint = false;
    CacheSettings cache = {}; // deviceBytes as well
    VoxelSettings voxels = {};
    PairSettings pairs = {};
    bool rtrad = false; // the preset
    bool deviceGather = false;
    bool live = false;
    bool layers = false;
    double layerError = 0;              // of each layer by itself; 0: any
    uint64_t layerBytes = 0;            // at most; 0: as much as there is
    uint64_t layerDeviceBytes = 0;      // of them on the device; 0: as much as there is
    Spill spill = Spill::None;          // at least
    const vk::Device* device = nullptr; // nullptr: testDevice()
};

struct Baked {
    FloatImage lighting, radiance;
    SolverProgress progress;
    PatchSet patches;
    uint32_t invalid = 0;
};

BakeSettings settingsOf(const BakeDesc& desc);

/// Bakes on the test device, or the description's own. Texels beside the charts stay empty.
Baked bakeScene(const Scene& scene, const BakeDesc& desc);

/// Makes a Baker of the scene, likewise, not yet stepped.
std::unique_ptr<Baker> makeBaker(const Scene& scene, const BakeDesc& desc);
/// Makes one of a scene that it may edit (Baker::apply).
std::unique_ptr<Baker> makeEditableBaker(Scene& scene, const BakeDesc& desc);

/// Returns the tracers that run on the test device.
std::vector<TracerKind> tracersOfTestDevice();

/// Expects that every tracer of the test device bakes what the first one does, within this relative error.
void expectTracersAgree(const Scene& scene, BakeDesc desc, double tolerance);

/// Returns the scene with every instance blown up by `factor` about the origin.
Scene scaled(Scene scene, float factor);

/// Describes the values of the red channel over the covered texels of a rectangle.
struct TexelStatistics {
    double mean = 0, min = 0, max = 0;
    uint32_t count = 0;
};
TexelStatistics statistics(const FloatImage& image, const TexelRect& rect);
double texel(const FloatImage& image, const TexelRect& rect, uint32_t column, uint32_t row);
/// Returns the root of the mean squared difference of R, G and B over the texels of coverage 1, relative to
/// b's mean.
double relativeError(const FloatImage& a, const FloatImage& b);

} // namespace relume
