#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// All of `text` as a finite number, "2", "-0.5", "+1e3". Nothing for nan, inf and what a double cannot hold.
std::optional<double> finiteNumber(std::string_view text);

/// All of `text` as decimal digits, "512"; no sign.
std::optional<uint64_t> wholeNumber(std::string_view text);

/// As finiteNumber, of what a float can hold.
std::optional<float> typedNumber(std::string_view text);

/// `count` of them with commas between, "1,2.5,-3"; empty where `text` is anything else.
std::vector<float> typedNumbers(std::string_view text, size_t count);

/// "512M": bytes, with K, M, G or T for powers of 1024. Throws UsageError, which names the option.
uint64_t typedMemory(const char* option, const std::string& text);

} // namespace relume
