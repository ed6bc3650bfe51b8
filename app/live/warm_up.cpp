#include "app/live/warm_up.h"

#include "bake/baker/make_solver.h"
#include "bake/layers/layer_solver.h"
#include "bake/show/publisher.h"
#include "bake/surface/cit_pass.h"
#include "bake/surface/patches.h"
#include "bake/trace/make_tracer.h"
#include "bake/vk/program.h"

#include <memory>

namespace relume {
namespace {

constexpr uint32_t kSize = 16; // edge of the lightmap [texels]

// A square of a metre under a sun and a sky: their layers need what those of any light do.
Scene makeSquare() {
    Scene scene;
    scene.materials.emplace_back();
    Primitive square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}};
    square.normals.assign(square.positions.size(), {0, 1, 0});
    square.texCoord0 = square.texCoord1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    square.indices = {0, 1, 2, 0, 2, 3};
    square.material = 0;
    scene.meshes.push_back({"square", {std::move(square)}, false});
    scene.instances.push_back({.name = "square", .mesh = 0});
    Light sun;
    sun.type = LightType::Directional;
    sun.intensity = 1.0f;
    sun.transform = glm::mat4({1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1});
    scene.lights.push_back(sun);
    scene.sky.radiance = glm::vec3(1.0f);
    return scene;
}

} // namespace

void warmUp(const vk::Device& device, const std::function<bool()>& wanted) {
    const Scene scene = makeSquare();
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kSize));
    const TextureGroup group = rasterizeTextureGroup(device, scene, mesh, {.size = kSize});
    const PatchSet patches = buildPatches(scene, mesh, group, {.pool = &device.workers()});
    if (wanted()) return;
    LightBuffers light(device, patches);
    std::string why;
    const std::unique_ptr<Tracer> tracer =
        makeTracer(chooseTracer(device.info(), why), device, patches.scene, light.patches);
    // The search for what stands in texels, which this square needs none of, has a kernel of its own.
    if (tracer->records()) const vk::ComputeProgram compiled(device, "places");
    SolverSettings settings;
    settings.method = Method::Hybrid;
    settings.layers.on = settings.live = true;
    settings.links.samples = LayerSolver::kPointsOfSamplePass;
    settings.links.allOver = false;
    const MadeSolver made = makeSolver({device, scene, patches, light, *tracer}, settings);
    Publisher publisher(device, patches, {});
    while (!allLit(made.layers->layers())) {
        if (wanted()) return;
        made.solver->step();
    }
    const LiveLight live = made.solver->liveLight();
    publisher.update({.values = *live.light, .chunks = publisher.allChunks(), .unit = 1.0f});
}

} // namespace relume
