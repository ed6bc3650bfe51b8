#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "assets/base/file_write.h"
#include "bake/solver/solver.h"

namespace relume {

/// The bake that a checkpoint belongs to: it is refused where any of these differ.
struct CheckpointKey {
    std::string version;  // of the program
    std::string settings; // "name=value" pairs, separated by spaces
    uint64_t scene = 0;   // sceneFingerprint
};

/// Returns a 64-bit hash of all that a bake reads from its scene: patches, triangles, materials, images and
/// lights.
uint64_t sceneFingerprint(const Scene& scene, const PatchSet& patches);

/// Writes where the solver stands, through a temporary file and piece by piece: memory for another copy of
/// its light is not needed. Returns the file's size [bytes]. Throws Error; `path` then is as it was.
uint64_t saveCheckpoint(const std::string& path, const CheckpointKey& key, Solver& solver,
                        OnFailure onFailure = OnFailure::Keep);

/// Returns the hash of all bytes before that a checkpoint ends with: for tests, which change what a damaged
/// file could not.
uint64_t checkpointHash(std::string_view bytes);

/// A checkpoint that was found to be whole. It holds the file open, not its light.
class Checkpoint {
public:
    /// Reads the whole file once. Throws Error when it cannot be read, is damaged, or was written by another
    /// version.
    Checkpoint(const std::string& path, const std::string& version);

    /// Makes the solver go on from here. Throws Error, naming what differs, when the checkpoint belongs to
    /// another scene or setting; the solver then is as it was.
    void restore(const CheckpointKey& key, Solver& solver);

private:
    struct Section {
        uint64_t offset = 0, size = 0; // [bytes] in the file
    };
    void check();
    void readHeader(const std::string& version);
    Section nextSection(uint64_t& offset);
    std::string text(const Section& section);
    template<typename T>
    std::vector<T> values(const Section& section);
    void read(uint64_t offset, void* data, uint64_t size);
    [[noreturn]] void fail(std::string why) const;

    std::string path_;
    std::ifstream file_;
    uint64_t end_ = 0; // of the sections
    std::string settings_;
    uint64_t scene_ = 0;
    SolverState state_;
    std::vector<Section> parts_;
};

} // namespace relume
