#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace relume {

/// All of `text` as a number that is finite.
std::optional<float> typedNumber(std::string_view text);

/// `count` of them with commas between, "1,2.5,-3"; empty where `text` is anything else.
std::vector<float> typedNumbers(std::string_view text, size_t count);

} // namespace relume
