#include "app/export/web/web_container.h"

#include "assets/base/error.h"

#include <fmt/format.h>
#include <zlib.h>

namespace relume {
namespace {

constexpr std::string_view kMagic = "RLMWEB01";
constexpr int kPackingLevel = 9;

std::string bytesOf(uint32_t number) {
    std::string bytes(4, '\0');
    for (size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<char>(number >> (8 * i) & 0xffu);
    return bytes;
}

} // namespace

int WebContainer::list(size_t bytes, size_t stride) {
    sections_.push_back({{"offset", bytes_.size()}, {"bytes", bytes}, {"stride", stride}});
    return static_cast<int>(sections_.size()) - 1;
}

int WebContainer::add(std::string_view bytes) {
    const int number = list(bytes.size(), 1);
    bytes_ += bytes;
    return number;
}

int WebContainer::addSorted(std::string_view bytes, size_t stride) {
    const int number = list(bytes.size(), stride);
    bytes_.reserve(bytes_.size() + bytes.size());
    for (size_t k = 0; k < stride; ++k)
        for (size_t i = k; i < bytes.size(); i += stride)
            bytes_ += bytes[i];
    return number;
}

std::string WebContainer::packed() const {
    nlohmann::json whole = header;
    whole["sections"] = sections_;
    // Names of files and lights may be no UTF-8, which JSON must be.
    const std::string text = whole.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const std::string plain =
        fmt::format("{}{}{}{}", kMagic, bytesOf(static_cast<uint32_t>(text.size())), text, bytes_);
    uLongf size = compressBound(static_cast<uLong>(plain.size()));
    std::string out(size, '\0');
    const int status =
        compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
                  static_cast<uLong>(plain.size()), kPackingLevel);
    if (status != Z_OK)
        throw Error("the page's data cannot be packed, as the memory is full: close programs");
    out.resize(size);
    return out;
}

std::string base64Of(std::string_view bytes) {
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t group = 0;
        const size_t count = std::min<size_t>(3, bytes.size() - i);
        for (size_t k = 0; k < 3; ++k)
            group = group << 8 | (k < count ? static_cast<uint8_t>(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            out += k <= count ? kLetters[group >> (18 - 6 * k) & 63u] : '=';
    }
    return out;
}

} // namespace relume
