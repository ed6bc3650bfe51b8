#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace relume {

/// Gathers what a page shows in one file: a header as JSON, and sections of bytes, which the header names by
/// number. The README of this room describes the form.
class WebContainer {
public:
    nlohmann::json header = nlohmann::json::object();

    /// Adds a section as it is and returns its number.
    int add(std::string_view bytes);
    /// Adds a section of values of one kind and returns its number. The bytes of its values are sorted, the
    /// first ones of all first, so that it packs well.
    template<class T>
    int addValues(std::span<const T> values) {
        return addSorted({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, sizeof(T));
    }

    /// Returns the file, packed by zlib [RFC 1950]. Throws Error where the memory is full.
    std::string packed() const;

private:
    int addSorted(std::string_view bytes, size_t stride);
    int list(size_t bytes, size_t stride);

    std::string bytes_;
    nlohmann::json sections_ = nlohmann::json::array();
};

/// Returns bytes as text [RFC 4648, section 4].
std::string base64Of(std::string_view bytes);

} // namespace relume
