#pragma once

#include <fstream>
#include <iterator>
#include <string>

namespace relume {

/// Returns the bytes of a file, or nothing where there is none.
inline std::string bytesOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace relume
