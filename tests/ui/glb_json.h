#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

namespace relume {

/// The bytes of a .glb whose JSON was changed.
inline std::string withJson(const std::string& glb, const std::function<void(nlohmann::json&)>& change) {
    constexpr size_t kHeader = 12, kChunkHeader = 8;
    const auto word = [](uint32_t value) {
        return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
    };
    uint32_t length = 0;
    std::memcpy(&length, glb.data() + kHeader, sizeof(length));
    nlohmann::json document = nlohmann::json::parse(glb.substr(kHeader + kChunkHeader, length));
    change(document);
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::string rest = glb.substr(kHeader + kChunkHeader + length);
    const size_t size = kHeader + kChunkHeader + text.size() + rest.size();
    return "glTF" + word(2) + word(static_cast<uint32_t>(size)) + word(static_cast<uint32_t>(text.size())) +
           "JSON" + text + rest;
}

} // namespace relume
