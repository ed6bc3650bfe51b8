#pragma once

#include <cstdint>
#include <string>
#include <string_view>

// These checks come before OpenEXR, which takes memory for whatever a header claims before it reads on.
namespace relume::exr {

/// Checks the headers of an OpenEXR file against its size: what they say of pixels, channels, tiles, chunks
/// and attributes must fit into that many bytes, packed as well as its codec can. Throws std::runtime_error
/// where they do not, and for what is not supported: deep data, subsampled channels. Passing does not mean
/// that OpenEXR can read the file.
void checkHeaders(std::string_view bytes);

} // namespace relume::exr
