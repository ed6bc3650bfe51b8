#include "app/text/near_names.h"

#include "assets/base/warnings.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace relume {
namespace {

constexpr size_t kMostHints = 4;
constexpr size_t kMostListed = 12; // names that still make a line

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

// Returns how many letters to put in, take out, replace or swap with their neighbour: the optimal string
// alignment distance [Damerau 1964].
size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
    for (size_t i = 0; i <= a.size(); ++i) {
        for (size_t j = 0; j <= b.size(); ++j) {
            cost[i][j] = i + j; // all taken out, all put in
            if (i == 0 || j == 0) continue;
            const size_t replaced = cost[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    }
    return cost.back().back();
}

std::string listed(const std::vector<std::string>& names, const char* last) {
    std::string text;
    for (size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? last : ", ") + inQuotes(names[i]);
    return text;
}

} // namespace

std::vector<std::string> nearNames(const std::string& typed, const std::vector<std::string>& names) {
    const std::string wanted = lowerCase(typed);
    // One letter in three may be mistyped; with two letters, any change would be another name.
    const size_t farthest = wanted.size() / 3;
    std::vector<std::pair<size_t, std::string>> found;
    for (const std::string& name : names) {
        const std::string candidate = lowerCase(name);
        const size_t letters = distance(wanted, candidate);
        if (letters <= farthest)
            found.emplace_back(letters, name);
        else if (!wanted.empty() && candidate.find(wanted) != std::string::npos)
            found.emplace_back(farthest + 1, name);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> near;
    for (const auto& entry : found)
        if (near.size() < kMostHints && std::find(near.begin(), near.end(), entry.second) == near.end())
            near.push_back(entry.second);
    return near;
}

std::string nearNamesHint(const std::string& typed, const std::vector<std::string>& names) {
    const std::vector<std::string> near = nearNames(typed, names);
    if (!near.empty()) return "did you mean " + listed(near, " or ") + "?";
    if (names.empty()) return "there is none";
    if (names.size() <= kMostListed) return "there is " + listed(names, " and ");
    const std::vector<std::string> first(names.begin(), names.begin() + kMostListed);
    return "there is " + listed(first, ", ") + " and " + std::to_string(names.size() - kMostListed) + " more";
}

} // namespace relume
