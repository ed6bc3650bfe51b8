#pragma once

#include <string>
#include <string_view>

namespace relume {

/// Tells what is damaged in a PNG whose pixels may be readable all the same.
struct PngDamage {
    std::string problem; // "its chunk 'IDAT' has a wrong checksum"; "": none is found, or it is no PNG
    std::string mended;  // where its end is missing: all whole chunks and an end, to be decoded instead
};

/// Looks at the chunks' checksums and for the end, which decoders pass over or give up at. Decodes nothing.
PngDamage findPngDamage(std::string_view bytes);

} // namespace relume
