#include "app/typed_numbers.h"

#include <charconv>
#include <cmath>

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

} // namespace relume
