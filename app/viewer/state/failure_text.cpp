#include "app/viewer/state/failure_text.h"

#include <filesystem>
#include <string_view>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBetween = ": "; // of a message's parts
constexpr const char* kNoReason = "the file cannot be opened";
constexpr const char* kUsualMend = "choose another file";

} // namespace

FailureText failureText(const OpenFailure& failure) {
    const fs::path path(failure.path);
    FailureText text{
        .name = path.filename().string(), .folder = path.parent_path().string(), .thing = {}, .mend = {}};
    if (text.name.empty()) text.name = failure.path; // a folder: it ends in a slash
    std::string rest = failure.message;
    const std::string start = failure.path + std::string(kBetween);
    if (rest.starts_with(start)) rest.erase(0, start.size());
    const size_t cut = rest.rfind(kBetween);
    text.thing = rest.substr(0, cut);
    if (cut != std::string::npos) text.mend = rest.substr(cut + kBetween.size());
    if (text.thing.empty()) text.thing = kNoReason;
    if (text.mend.empty()) text.mend = kUsualMend;
    return text;
}

} // namespace relume
