#include "app/offline/compression_option.h"

#include "app/text/option_checks.h"
#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <utility>

#include <CLI/CLI.hpp>

namespace relume {
namespace {

constexpr std::array<std::pair<const char*, ExrCompression>, 5> kCompressions = {{
    {"none", ExrCompression::Off},
    {"rle", ExrCompression::Rle},
    {"zips", ExrCompression::Zips},
    {"zip", ExrCompression::Zip},
    {"piz", ExrCompression::Piz},
}};

bool isExr(const std::string& output) {
    std::string ending = std::filesystem::path(output).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending == ".exr";
}

} // namespace

CLI::Option* addCompressionOption(CLI::App& command, std::string& compression) {
    std::vector<std::string> names;
    for (const auto& [name, kind] : kCompressions)
        names.emplace_back(name);
    return command
        .add_option("--compression", compression,
                    "How OpenEXR files are packed, which no pixel shows: none is the quickest, zip (default) "
                    "and piz are the smallest")
        ->check(oneOf(names));
}

ExrCompression compressionOf(const std::string& name) {
    for (const auto& [known, kind] : kCompressions)
        if (name == known) return kind;
    ASSERT(name.empty());
    return kExrCompression;
}

void checkCompression(const std::string& compression, const std::vector<std::string>& outputs) {
    if (compression.empty() || std::any_of(outputs.begin(), outputs.end(), isExr)) return;
    throw UsageError("--compression " + compression +
                     ": is of OpenEXR only: leave it out, or give the lightmap a name that ends in .exr");
}

} // namespace relume
