// The container is specified in: W3C, "Portable Network Graphics (PNG) Specification (Second Edition)", 2003,
// section 5.
#include "assets/images/png_check.h"

#include "assets/base/warnings.h"

#include <zlib.h>

#include <cstddef>
#include <cstdint>

namespace relume {
namespace {

constexpr std::string_view kPngMagic("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kPngEnd("\0\0\0\0IEND\xae\x42\x60\x82", 12);
constexpr size_t kAroundData = 12; // [bytes] length and type before a chunk's data, the checksum behind them

uint32_t bigEndian(std::string_view bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = at; i < at + 4; ++i)
        value = value << 8 | static_cast<uint8_t>(bytes[i]);
    return value;
}

} // namespace

PngDamage findPngDamage(std::string_view bytes) {
    PngDamage damage;
    if (!bytes.starts_with(kPngMagic)) return damage;
    size_t at = kPngMagic.size();
    while (bytes.size() - at >= kAroundData) {
        const size_t length = bigEndian(bytes, at);
        if (length > bytes.size() - at - kAroundData) break;
        const std::string_view type = bytes.substr(at + 4, 4), checked = bytes.substr(at + 4, 4 + length);
        const uint32_t told = bigEndian(bytes, at + 8 + length);
        const uint64_t right = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
        if (told != right && damage.problem.empty())
            damage.problem = "its chunk " + inQuotes(std::string(type)) + " has a wrong checksum";
        at += kAroundData + length;
        if (type == "IEND") return damage;
    }
    damage.problem = "it ends before its last chunk, IEND";
    damage.mended.assign(bytes.substr(0, at));
    damage.mended += kPngEnd;
    return damage;
}

} // namespace relume
