#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace relume::test {

/// Returns a number as files have it, lowest byte first.
template<typename T>
std::string raw(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

inline std::string text(const std::string& value) {
    return value + '\0';
}

/// Makes OpenEXR headers, right or wrong: what they claim need not be there.
struct ExrClaims {
    int32_t right = 3, bottom = 3; // the data window begins at (0, 0)
    int32_t channels = 3;
    int32_t pixelType = 2; // float
    int32_t sampling = 1;
    uint8_t compression = 3; // ZIP
    uint32_t tileWidth = 0, tileHeight = 0;
    std::string type = ""; // of a part; "": none is told
    std::string more = ""; // further attributes
    uint32_t version = 2;  // with flags

    static std::string attribute(const std::string& name, const std::string& kind, const std::string& value) {
        return text(name) + text(kind) + raw(static_cast<int32_t>(value.size())) + value;
    }
    std::string header() const {
        std::string list;
        for (int32_t c = 0; c < channels; ++c)
            list += text("c" + std::to_string(c)) + raw(pixelType) + raw(0) + raw(sampling) + raw(sampling);
        const std::string window = raw(0) + raw(0) + raw(right) + raw(bottom);
        std::string out = attribute("channels", "chlist", list + '\0') +
                          attribute("compression", "compression", raw(compression)) +
                          attribute("dataWindow", "box2i", window) +
                          attribute("displayWindow", "box2i", window) +
                          attribute("lineOrder", "lineOrder", raw(uint8_t{0})) +
                          attribute("pixelAspectRatio", "float", raw(1.0f)) +
                          attribute("screenWindowCenter", "v2f", raw(0.0f) + raw(0.0f)) +
                          attribute("screenWindowWidth", "float", raw(1.0f));
        if (tileWidth > 0)
            out += attribute("tiles", "tiledesc", raw(tileWidth) + raw(tileHeight) + raw(uint8_t{0}));
        if (!type.empty()) out += attribute("type", "string", type);
        return out + more + '\0';
    }
    /// Returns a whole file; `behind` is what follows the header.
    std::string bytes(const std::string& behind = "") const {
        const uint32_t tiled = tileWidth > 0 ? 0x200u : 0u;
        return raw(20000630) + raw(version | tiled) + header() + behind;
    }
};

} // namespace relume::test
