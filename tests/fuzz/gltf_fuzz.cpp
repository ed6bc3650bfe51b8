// A scene is treated as every command begins with it: read, given lightmap UVs, flattened.
#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/unwrap.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/gltf_corpus.h"

namespace relume::fuzz {

std::vector<std::string> corpus() {
    return gltfCorpus();
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace relume;
    const std::string path = fuzz::asFile(data, size, fuzz::endingOfGltf(data, size));
    try {
        Scene scene = loadGltf(path);
        unwrap(scene, {.size = 64});
        flatten(scene, buildAtlas(scene, 64));
    } catch (const Error& error) {
        fuzz::checkMessage(error, path);
    }
    return 0;
}
