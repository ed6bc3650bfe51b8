#include "app/text/typed_numbers.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <exception>

namespace relume {

namespace {

template<typename Number>
std::optional<Number> allOf(std::string_view text) {
    Number value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

// Reads a finite number. from_chars knows no plus sign, but users may write one.
template<typename Number>
std::optional<Number> finiteOf(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    const std::optional<Number> value = allOf<Number>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

} // namespace

std::optional<double> finiteNumber(std::string_view text) {
    return finiteOf<double>(text);
}

std::optional<uint64_t> wholeNumber(std::string_view text) {
    return allOf<uint64_t>(text);
}

std::optional<float> typedNumber(std::string_view text) {
    return finiteOf<float>(text);
}

std::vector<float> typedNumbers(std::string_view text, size_t count) {
    std::vector<float> numbers;
    while (true) {
        const size_t comma = text.find(',');
        const std::optional<float> number = typedNumber(text.substr(0, comma));
        if (!number || numbers.size() == count) return {};
        numbers.push_back(*number);
        if (comma == std::string_view::npos) break;
        text.remove_prefix(comma + 1);
    }
    if (numbers.size() != count) numbers.clear();
    return numbers;
}

uint64_t typedMemory(const char* option, const std::string& text) {
    const auto wrong = [&] {
        return UsageError(std::string(option) + " " + text + ": give a size above 0 like 512M or 2G");
    };
    size_t used = 0;
    double value = 0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) {
        throw wrong();
    }
    std::string unit = text.substr(used);
    std::transform(unit.begin(), unit.end(), unit.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    if (unit.ends_with("IB"))
        unit.resize(unit.size() - 2);
    else if (unit.size() > 1 && unit.ends_with("B"))
        unit.pop_back();
    constexpr std::array<const char*, 5> kUnits = {"", "K", "M", "G", "T"};
    const auto found = std::find(kUnits.begin(), kUnits.end(), unit == "B" ? "" : unit);
    if (found == kUnits.end()) throw wrong();
    const double bytes = std::ldexp(value, 10 * static_cast<int>(found - kUnits.begin()));
    constexpr double kMost = 1e18;
    if (!(bytes >= 1.0 && bytes <= kMost)) throw wrong();
    return static_cast<uint64_t>(bytes);
}

std::optional<float> typedExposure(const std::string& text) {
    if (text == "auto") return std::nullopt;
    constexpr float kMaxExposure = 64; // EV: a factor that floats hold with room to spare
    const std::optional<float> exposure = typedNumber(text);
    if (!exposure || std::abs(*exposure) > kMaxExposure)
        throw UsageError("--exposure: '" + text + "' is neither auto nor a number from -64 to 64");
    return exposure;
}

} // namespace relume
