#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// All of `text` as a number that is finite.
std::optional<float> typedNumber(std::string_view text);

/// `count` of them with commas between, "1,2.5,-3"; empty where `text` is anything else.
std::vector<float> typedNumbers(std::string_view text, size_t count);

/// "512M": bytes, with K, M, G or T for powers of 1024. Throws UsageError, which names the option.
uint64_t typedMemory(const char* option, const std::string& text);

} // namespace relume
