#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// Returns all of `text` as a finite number, "2", "-0.5", "+1e3", or nothing for nan, inf and what a double
/// cannot hold.
std::optional<double> finiteNumber(std::string_view text);

/// Returns all of `text` as decimal digits, "512", without a sign.
std::optional<uint64_t> wholeNumber(std::string_view text);

/// Returns what finiteNumber() does, for what a float can hold.
std::optional<float> typedNumber(std::string_view text);

/// Returns `count` of them with commas between, "1,2.5,-3"; empty where `text` is anything else.
std::vector<float> typedNumbers(std::string_view text, size_t count);

/// Returns the bytes that "512M" means, with K, M, G or T for powers of 1024. Throws UsageError, which names
/// the option.
uint64_t typedMemory(const char* option, const std::string& text);

/// Returns the exposure [EV] that --exposure gives: none for "auto". Throws UsageError for what is neither
/// that nor a number from -64 to 64.
std::optional<float> typedExposure(const std::string& text);

} // namespace relume
