#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/world_mesh.h"
#include "assets/generate/generate.h"
#include "assets/gltf/gltf.h"
#include "bake/trace/bvh_builder.h"

#include <filesystem>

#include <benchmark/benchmark.h>

// This measures what happens on the CPU before the first ray, on a scene of some 30k triangles. Rays and
// gathers are measured in their real kernels by `relume bench trace`.
namespace relume {
namespace {

constexpr uint32_t kSize = 512; // lightmap edge [texels], the default of a bake

const Scene& scene() {
    static const Scene made = generateScene("cornell_statue");
    return made;
}

const WorldMesh& mesh() {
    static const WorldMesh made = flatten(scene(), buildAtlas(scene(), kSize));
    return made;
}

void countTriangles(benchmark::State& state) {
    state.SetItemsProcessed(static_cast<int64_t>(state.iterations()) * mesh().triangleCount());
}

void loadScene(benchmark::State& state) {
    const std::string path = (std::filesystem::temp_directory_path() / "relume_bench.glb").string();
    saveGlb(scene(), path);
    for (auto _ : state)
        benchmark::DoNotOptimize(loadGltf(path));
    countTriangles(state);
    std::filesystem::remove(path);
}
BENCHMARK(loadScene)->Unit(benchmark::kMillisecond)->UseRealTime();

void chooseAtlas(benchmark::State& state) {
    for (auto _ : state)
        benchmark::DoNotOptimize(buildAtlas(scene(), kSize));
    countTriangles(state);
}
BENCHMARK(chooseAtlas)->Unit(benchmark::kMillisecond)->UseRealTime();

void flattenScene(benchmark::State& state) {
    const LightmapAtlas atlas = buildAtlas(scene(), kSize);
    for (auto _ : state)
        benchmark::DoNotOptimize(flatten(scene(), atlas));
    countTriangles(state);
}
BENCHMARK(flattenScene)->Unit(benchmark::kMillisecond)->UseRealTime();

void buildTree(benchmark::State& state) {
    WorkerPool pool(0);
    for (auto _ : state)
        benchmark::DoNotOptimize(buildBvh(mesh(), &pool));
    countTriangles(state);
}
BENCHMARK(buildTree)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace
} // namespace relume

BENCHMARK_MAIN();
