// Inputs are read as they come, and with the hash that fits: it keeps damage out, but not what somebody made.
#include "assets/base/error.h"
#include "bake/output/checkpoint.h"
#include "tests/fuzz/fuzz.h"
#include "tests/text.h"
#include "tests/unit/parked_solver.h"

#include <cstring>

namespace relume::fuzz {
namespace {

const CheckpointKey kKey = {"1.2.3", "size=64 samples=16 smooth=1", 0x0123456789abcdefull};

void readCheckpoint(const std::string& bytes) {
    const std::string path =
        asFile(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), ".checkpoint");
    try {
        test::ParkedSolver solver({16, 0, 5});
        Checkpoint(path, kKey.version).restore(kKey, solver);
    } catch (const Error& error) {
        checkMessage(error, path);
    }
}

} // namespace

std::vector<std::string> corpus() {
    std::vector<std::string> corpus;
    for (const std::vector<size_t>& sizes : {std::vector<size_t>{16, 0, 5}, {}, {3000}}) {
        test::ParkedSolver solver(sizes);
        solver.fill();
        const std::string path = besideInputs("some.checkpoint");
        saveCheckpoint(path, kKey, solver);
        corpus.push_back(bytesOf(path));
    }
    return corpus;
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace relume;
    std::string bytes(reinterpret_cast<const char*>(data), size);
    fuzz::readCheckpoint(bytes);
    if (size < sizeof(uint64_t)) return 0;
    const uint64_t hash = checkpointHash({bytes.data(), size - sizeof(hash)});
    std::memcpy(bytes.data() + size - sizeof(hash), &hash, sizeof(hash));
    fuzz::readCheckpoint(bytes);
    return 0;
}
