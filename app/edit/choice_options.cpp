#include "app/edit/choice_options.h"

#include "app/text/option_checks.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace relume {
namespace {

constexpr double kLongestTime = 1e6; // [s], eleven days: no animation is as long

} // namespace

void addChoiceOptions(CLI::App& command, GltfChoice& choice) {
    command
        .add_option(
            "--scene", choice.scene,
            "The scene of the file to read, by its name or its number from 0 (default: the file's own)")
        ->type_name("NAME");
    command
        .add_option("--variant", choice.variant,
                    "The variant of its materials (default: the file's own materials)")
        ->type_name("NAME");
    command
        .add_option("--time", choice.time,
                    "Pose what moves as the file's first animation does after so many seconds (default: the "
                    "rest pose)")
        ->check(numberFrom(0.0, kLongestTime));
}

std::string typedChoice(const GltfChoice& choice) {
    std::string text;
    if (!choice.scene.empty()) text += fmt::format(" --scene '{}'", choice.scene);
    if (!choice.variant.empty()) text += fmt::format(" --variant '{}'", choice.variant);
    if (choice.time) text += fmt::format(" --time {:g}", *choice.time);
    return text;
}

} // namespace relume
