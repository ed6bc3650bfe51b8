#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace relume {

/// Finds the files that a model names: material libraries and pictures. Such names come from another machine,
/// with backslashes, drives, folders that are not here, and letters of another case. What is looked for is a
/// regular file in the model's folder, in the folder above it, or in a folder below one of these two. A model
/// can name no other file, nor can a link lead to one.
class NearFiles {
public:
    explicit NearFiles(const std::string& model);
    /// Returns the path of the file that is meant, or "" where none is near. The whole of a relative path is
    /// tried first, then ever shorter ends of it, then the name alone in folders where pictures use to be.
    std::string find(const std::string& reference);

private:
    using Parts = std::vector<std::string>;
    std::string findParts(const Parts& parts, size_t ups, bool relative);
    std::string findUsual(const std::string& name);
    std::string below(const std::filesystem::path& folder, const Parts& parts, size_t first = 0);
    std::string entryOf(const std::filesystem::path& folder, const std::string& name);
    bool isNear(const std::filesystem::path& path) const;

    std::filesystem::path folder_, above_; // of the model; above_ is empty where there is none but the root
    std::filesystem::path outermost_;      // canonical; nothing is found outside
    std::string stem_;                     // of the model
    std::map<std::filesystem::path, std::vector<std::string>> listings_; // names in a folder, sorted
};

} // namespace relume
