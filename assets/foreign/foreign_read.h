#pragma once

#include <memory>
#include <string>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include "assets/foreign/foreign_types.h"
#include "assets/foreign/near_files.h"

namespace relume::foreign {

/// Reads files by libassimp: triangles, texture coordinates for every picture, and no more.
class Reader {
public:
    /// Files that the file names are looked for by `near`, which must outlive the reader.
    Reader(NearFiles& near, const ForeignProgress& progress);

    /// Returns what a file holds, which lives as long as the reader. All indices in it are in range. Throws
    /// Error, and bad_alloc.
    const aiScene& read(const std::string& path);
    /// Tells whether the file has points or lines, which are left out.
    bool skippedPoints() const { return skippedPoints_; }
    /// Tells whether it has animations, and whether it has skins, both of which are left out.
    bool animated() const { return animated_; }
    bool skinned() const { return skinned_; }
    /// Returns the material libraries (.mtl) that the file names and that are not near it.
    const std::vector<std::string>& missingLibraries() const { return missingLibraries_; }

private:
    [[noreturn]] void fail(const std::string& path) const;
    void configure();
    void keepNamedLibraries(const std::string& path);

    NearFiles& near_;
    Assimp::Importer importer_;
    bool skippedPoints_ = false, animated_ = false, skinned_ = false;
    std::vector<std::string> missingLibraries_;
};

} // namespace relume::foreign
