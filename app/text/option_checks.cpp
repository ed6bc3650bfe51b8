#include "app/text/option_checks.h"

#include "app/text/typed_numbers.h"
#include "assets/base/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <optional>

namespace relume {
namespace {

using ReadText = std::function<std::optional<std::string>(const std::string&)>;

/// Makes a check of which `read` returns the text as CLI11 must convert it, or nothing where it is not
/// allowed.
CLI::Validator checkOf(const std::string& allowed, const std::string& mend, ReadText read) {
    const auto check = [mend, read = std::move(read)](std::string& text) -> std::string {
        std::optional<std::string> good = read(text);
        if (!good) return fmt::format("{} is not allowed: {}", inQuotes(text), mend);
        text = std::move(*good);
        return "";
    };
    return CLI::Validator(check, allowed, kOptionCheck);
}

// Returns a number as users write it, without the zeros of a float.
std::string shortNumber(double value) {
    return fmt::format("{:.12g}", value);
}

std::string inLowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

CLI::Validator numberCheck(const std::string& allowed, const char* from,
                           std::function<bool(double)> isAllowed) {
    return checkOf(allowed, fmt::format("give a number {}{}", from, allowed),
                   [isAllowed = std::move(isAllowed)](const std::string& text) -> std::optional<std::string> {
                       const std::optional<double> value = finiteNumber(text);
                       return value && isAllowed(*value) ? std::optional(text) : std::nullopt;
                   });
}

CLI::Validator wordCheck(std::vector<std::string> words, bool anyCase) {
    const std::string allowed = fmt::format("{{{}}}", fmt::join(words, ","));
    std::string listed;
    for (size_t i = 0; i < words.size(); ++i)
        listed += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    return checkOf(
        allowed, "choose " + listed,
        [words = std::move(words), anyCase](const std::string& text) -> std::optional<std::string> {
            const auto found = std::find(words.begin(), words.end(), anyCase ? inLowerCase(text) : text);
            return found == words.end() ? std::nullopt : std::optional(*found);
        });
}

} // namespace

CLI::Validator numberFrom(double least, double most) {
    return numberCheck(shortNumber(least) + " to " + shortNumber(most), "from ",
                       [=](double value) { return value >= least && value <= most; });
}

CLI::Validator numberAbove(double above, double most) {
    return numberCheck("above " + shortNumber(above) + ", at most " + shortNumber(most), "",
                       [=](double value) { return value > above && value <= most; });
}

CLI::Validator wholeFrom(uint64_t least, uint64_t most) {
    const std::string allowed = fmt::format("{} to {}", least, most);
    return checkOf(allowed, "give a whole number from " + allowed,
                   [=](const std::string& text) -> std::optional<std::string> {
                       const std::optional<uint64_t> value = wholeNumber(text);
                       if (!value || *value < least || *value > most) return std::nullopt;
                       return std::to_string(*value); // CLI11 takes a leading 0 for an octal number
                   });
}

CLI::Validator wholeFromOr(uint64_t least, uint64_t most, const std::string& word) {
    const std::string allowed = fmt::format("{} to {}, or {}", least, most, word);
    return checkOf(allowed, "give a whole number from " + allowed,
                   [=](const std::string& text) -> std::optional<std::string> {
                       if (text == word) return text;
                       const std::optional<uint64_t> value = wholeNumber(text);
                       if (!value || *value < least || *value > most) return std::nullopt;
                       return std::to_string(*value);
                   });
}

CLI::Validator oneOf(std::vector<std::string> words) {
    return wordCheck(std::move(words), false);
}

CLI::Validator oneOfAnyCase(std::vector<std::string> words) {
    return wordCheck(std::move(words), true);
}

CLI::Validator powerOfTwo(uint32_t least, uint32_t most) {
    std::vector<std::string> words;
    for (uint64_t value = least; value <= most; value *= 2)
        words.push_back(std::to_string(value));
    return wordCheck(std::move(words), false);
}

CLI::Validator existingFolder() {
    return checkOf("FOLDER", "name a folder that exists", [](const std::string& text) {
        std::error_code code;
        return std::filesystem::is_directory(text, code) ? std::optional(text) : std::nullopt;
    });
}

} // namespace relume
