#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "assets/foreign/foreign_build.h"

namespace relume::foreign {

/// Makes images of the pictures that a file names or holds, each once. PNG and JPEG files are taken as they
/// are; others (TGA, BMP, GIF, PSD, PNM, ...) are decoded to 8 bits.
class Pictures {
public:
    explicit Pictures(Build& build) : build_(build) {}

    /// Returns the image of a picture that a material names, or -1, with a warning, where it cannot be read.
    int image(const std::string& reference, const std::string& material);
    /// The same with the alpha that another picture tells: its own alpha, or its grey where it has none, from
    /// the nearest of its pixels. It may be the same picture. `masked` tells whether there is such an alpha.
    struct Masked {
        int image = -1;
        bool masked = false;
    };
    Masked imageWithAlpha(const std::string& reference, const std::string& alpha,
                          const std::string& material);

private:
    struct Picture {
        std::string key;            // tells it from others
        std::vector<uint8_t> bytes; // of its file
        Image image;                // decoded
        bool asItIs = false;        // its bytes can stay
    };
    bool read(const std::string& reference, const std::string& material, Picture& picture);
    bool readEmbedded(const aiTexture& texture, Picture& picture) const;
    bool decode(Picture& picture) const;
    int add(Image image, std::vector<uint8_t> bytes);

    Build& build_;
    std::map<std::string, int> images_;                            // by key
    std::map<std::pair<std::string, std::string>, int> withAlpha_; // by both keys
};

} // namespace relume::foreign
