#include "app/offline/chosen_lights.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "bake/lights/light_source.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

// All of them, as a script may have to name each.
std::string listOf(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + inQuotes(name);
    return names.empty() ? "nothing shines in the scene" : "the scene has " + text;
}

// Returns the longest name that the text begins with and that ends there or before a comma; nullptr: none.
const std::string* nameAhead(std::string_view text, const std::vector<std::string>& names) {
    const std::string* longest = nullptr;
    for (const std::string& name : names) {
        const bool ends =
            text.size() == name.size() || (text.size() > name.size() && text[name.size()] == ',');
        if (ends && text.starts_with(name) && (!longest || name.size() > longest->size())) longest = &name;
    }
    return longest;
}

} // namespace

std::vector<std::string> lightNames(const Scene& scene) {
    std::vector<std::string> names;
    for (const LightSource& source : lightSources(scene))
        names.push_back(source.name);
    return names;
}

std::vector<std::string> chosenLights(const std::string& option, const std::vector<std::string>& typed,
                                      const std::vector<std::string>& names) {
    std::set<std::string> chosen;
    const auto fail = [&](std::string_view name, const char* why) {
        throw UsageError(
            fmt::format("{}: {} {}: {}", option, inQuotes(std::string(name)), why, listOf(names)));
    };
    for (const std::string& text : typed) {
        std::string_view rest = text;
        for (bool more = true; more;) {
            const std::string* name = nameAhead(rest, names);
            if (!name) fail(rest.substr(0, rest.find(',')), "is no light");
            if (!chosen.insert(*name).second) fail(*name, "is named twice");
            more = rest.size() > name->size();
            if (more) rest.remove_prefix(name->size() + 1);
        }
    }
    if (chosen.empty()) throw UsageError(fmt::format("{}: names no light: {}", option, listOf(names)));
    std::vector<std::string> ordered;
    std::copy_if(names.begin(), names.end(), std::back_inserter(ordered),
                 [&](const std::string& name) { return chosen.contains(name); });
    return ordered;
}

} // namespace relume
