#include "app/viewer/state/failure_text.h"

#include <filesystem>
#include <string_view>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBetween = ": "; // of a message's parts
constexpr const char* kNoReason = "the file cannot be opened";
constexpr const char* kUsualMend = "choose another file";
constexpr const char* kUndrawnMend =
    "make it smaller, or close other programs; it is baked and exported all the same";

} // namespace

FailureText failureText(const OpenFailure& failure) {
    const fs::path path(failure.path);
    FailureText text{.title = failure.undrawn ? "This scene cannot be drawn" : "This file cannot be opened",
                     .name = path.filename().string(),
                     .folder = path.parent_path().string(),
                     .thing = {},
                     .mend = {}};
    if (text.name.empty()) text.name = failure.path; // a folder: it ends in a slash
    std::string rest = failure.message;
    const std::string start = failure.path + std::string(kBetween);
    if (rest.starts_with(start)) rest.erase(0, start.size());
    if (failure.undrawn) { // OpenGL says what it has no room for, and not what helps
        text.thing = rest;
        text.mend = kUndrawnMend;
        return text;
    }
    const size_t cut = rest.rfind(kBetween);
    text.thing = rest.substr(0, cut);
    if (cut != std::string::npos) text.mend = rest.substr(cut + kBetween.size());
    if (text.thing.empty()) text.thing = kNoReason;
    if (text.mend.empty()) text.mend = kUsualMend;
    return text;
}

} // namespace relume
