#include "assets/base/uri.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace relume {
namespace {

int hexDigit(char c) {
    const char* const digits = "0123456789abcdef";
    const char* const found =
        std::find(digits, digits + 16, static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    return found == digits + 16 ? -1 : static_cast<int>(found - digits);
}

// Returns the value of a digit of base64 (RFC 4648), or -1 for another character.
int base64Digit(char c) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t found = kDigits.find(c);
    return found == std::string_view::npos ? -1 : static_cast<int>(found);
}

// Returns how many bytes follow the first one of a letter, or -1 where it begins none.
int followersOf(unsigned char first) {
    if (first < 0x80) return 0;
    if (first >= 0xc2 && first < 0xe0) return 1;
    if (first >= 0xe0 && first < 0xf0) return 2;
    return first >= 0xf0 && first < 0xf5 ? 3 : -1;
}

} // namespace

bool isUtf8(std::string_view text) {
    for (size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i++]);
        const int followers = followersOf(first);
        if (followers < 0) return false;
        uint32_t letter = followers == 0 ? first : first & (0x3fu >> followers);
        for (int k = 0; k < followers; ++k, ++i) {
            if (i == text.size()) return false;
            const auto next = static_cast<unsigned char>(text[i]);
            if ((next & 0xc0) != 0x80) return false;
            letter = letter << 6 | (next & 0x3fu);
        }
        // Spellings that are too long, halves of UTF-16 pairs and what lies beyond Unicode are no letters.
        const bool tooLong = (followers == 2 && letter < 0x800) || (followers == 3 && letter < 0x10000);
        if (tooLong || (letter >= 0xd800 && letter < 0xe000) || letter > 0x10ffff) return false;
    }
    return true;
}

std::string decodedUri(std::string_view uri) {
    std::string out;
    for (size_t i = 0; i < uri.size(); ++i) {
        const bool escape = uri[i] == '%' && i + 2 < uri.size();
        const int high = escape ? hexDigit(uri[i + 1]) : -1, low = escape ? hexDigit(uri[i + 2]) : -1;
        if (high < 0 || low < 0) {
            out += uri[i];
        } else {
            out += static_cast<char>(high * 16 + low);
            i += 2;
        }
    }
    return out;
}

std::string encodedUri(std::string_view path) {
    const bool letters = isUtf8(path);
    std::string out;
    for (const char c : path) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte >= 0x80 ? letters
                                        : std::isalnum(byte) != 0 ||
                                              std::string_view("-._~/").find(c) != std::string_view::npos;
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return out;
}

bool isRelativeUri(std::string_view uri) {
    return !uri.empty() && uri[0] != '/' && uri[0] != '#' &&
           uri.find(':') > std::min(uri.find('/'), uri.size() - 1);
}

std::optional<std::vector<uint8_t>> bytesOfDataUri(std::string_view uri) {
    constexpr std::string_view kScheme = "data:", kForm = ";base64";
    const size_t comma = uri.find(',');
    if (!uri.starts_with(kScheme) || comma == std::string_view::npos ||
        !uri.substr(0, comma).ends_with(kForm))
        return std::nullopt;
    const std::string_view text = uri.substr(comma + 1);
    std::vector<uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3);
    uint32_t word = 0;
    int bits = 0; // of the word that are not yet in a byte
    for (const char c : text) {
        const int digit = base64Digit(c);
        if (digit < 0) break;
        word = word << 6 | static_cast<uint32_t>(digit);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes.push_back(static_cast<uint8_t>(word >> bits));
    }
    return bytes;
}

std::string dataUriOf(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string uri = "data:application/octet-stream;base64,";
    uri.reserve(uri.size() + (bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t given = std::min<size_t>(bytes.size() - i, 3);
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k)
            word = word << 8 | (k < given ? static_cast<uint8_t>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            uri += k <= given ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
    return uri;
}

} // namespace relume
