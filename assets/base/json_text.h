#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace relume {

/// Returns `text`, which holds the JSON `before`, changed to hold `after`. What is alike in both stays to the
/// letter, white space and the spelling of numbers included; what is new is laid out as its surroundings are.
/// Members and elements keep their order; new ones come last.
std::string patchJsonText(std::string_view text, const nlohmann::ordered_json& before,
                          const nlohmann::ordered_json& after);

} // namespace relume
