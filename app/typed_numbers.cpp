#include "app/typed_numbers.h"

#include "assets/error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <exception>

namespace relume {

std::optional<float> typedNumber(std::string_view text) {
    float value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
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

} // namespace relume
