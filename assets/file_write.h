#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace relume {

/// Writes a file through a temporary one in the same folder, flushed to the disk and then renamed: afterwards
/// `path` holds all bytes, or what it held before. A symbolic link is followed. Throws Error, leaving no
/// temporary file.
void writeFileAtomically(const std::string& path, std::string_view bytes);

/// Throws Error where writing `path` is sure to fail: its folder is missing or unwritable, it is a folder
/// itself, or there is no space for `bytes`. Changes nothing.
void checkFileWritable(const std::string& path, uint64_t bytes);

} // namespace relume
