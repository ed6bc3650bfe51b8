#include "app/edit/edit_options.h"

#include "assets/model/light_names.h"
#include "app/text/near_names.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include <map>
#include <utility>

namespace relume {
namespace {

struct OptionRow {
    const char *option, *form, *help;
};

constexpr OptionRow kOptions[] = {
    {"--set", "NAME.PROP=VALUE",
     "Set a property. Lights: name, intensity [cd, lux, cd/m^2], color (#rrggbb, or linear r,g,b), "
     "temperature "
     "[K], radius [m], angle [degrees], size (w,h [m]), range [m], inner, outer [degrees from the axis]. "
     "Objects "
     "that shine: strength [cd/m^2], color, temperature. Materials: baseColor, emission (r,g,b [cd/m^2]), "
     "strength. 'Sky': intensity [cd/m^2], color, temperature, rotation [degrees], file"},
    {"--move", "NAME=X,Y,Z", "Put a light or an object at a point [m]; NAME+=X,Y,Z shifts it"},
    {"--rotate", "NAME=X,Y,Z",
     "Turn a light or an object to these Euler angles [degrees]: about the world's X, then Y, then Z"},
    {"--aim", "NAME=X,Y,Z", "Turn a light so that it shines at a point [m]"},
    {"--add", "TYPE,KEY=VALUE,...",
     "Add a point, spot, directional, rectangle or disc light, or a sky; keys: the properties of --set, and "
     "position, rotation, aim"},
    {"--duplicate", "NAME[=NEW]", "Add a second light like this one"},
    {"--delete", "NAME", "Take away a light, or 'Sky'"},
    {"--hide", "NAME", "Leave an object out"},
    {"--show", "NAME", "Take a hidden object in again"},
};

using OptionText = std::string_view;

glm::vec3 pointOf(OptionText text) {
    const std::vector<float> numbers = typedNumbers(text, 3);
    if (numbers.empty())
        throw UsageError(
            fmt::format("{} are no three finite numbers: give x,y,z", inQuotes(std::string(text))));
    return {numbers[0], numbers[1], numbers[2]};
}

std::string requireName(OptionText name, const char* form) {
    if (name.empty()) throw UsageError(fmt::format("names nothing: write {}", form));
    return std::string(name);
}

// Splits "NAME=VALUE"; a name may hold a '=', a value none.
std::pair<OptionText, OptionText> splitLast(OptionText text, const char* form) {
    const size_t equals = text.rfind('=');
    if (equals == OptionText::npos || equals == 0) throw UsageError(fmt::format("write {}", form));
    return {text.substr(0, equals), text.substr(equals + 1)};
}

Property requireProperty(OptionText name) {
    if (const std::optional<Property> property = propertyOf(name)) return *property;
    throw UsageError(
        fmt::format("{} is no property: there is {}", inQuotes(std::string(name)), propertyNames()));
}

// Reads "NAME.PROPERTY=VALUE". The name goes up to the last '.' before the first '=' that a property stands
// before.
SetEdit setOf(OptionText text, const char* form) {
    size_t first = OptionText::npos;
    for (size_t equals = text.find('='); equals != OptionText::npos; equals = text.find('=', equals + 1)) {
        const size_t dot = text.rfind('.', equals);
        if (dot == OptionText::npos || dot == 0) continue;
        if (const auto property = propertyOf(text.substr(dot + 1, equals - dot - 1)))
            return {std::string(text.substr(0, dot)), settingOf(*property, text.substr(equals + 1))};
        first = std::min(first, equals);
    }
    if (first == OptionText::npos) throw UsageError(fmt::format("write {}", form));
    const size_t dot = text.rfind('.', first);
    requireProperty(text.substr(dot + 1, first - dot - 1));
    throw UsageError(fmt::format("write {}", form));
}

MoveEdit moveOf(OptionText text, const char* form) {
    auto [name, point] = splitLast(text, form);
    const bool relative = name.ends_with('+');
    if (relative) name.remove_suffix(1);
    return {requireName(name, form), pointOf(point), relative};
}

// Splits "KEY=VALUE,...". Values may hold commas: what has no '=' belongs to the value before.
std::vector<std::pair<std::string, std::string>> keysOf(OptionText text) {
    std::vector<std::pair<std::string, std::string>> keys;
    while (!text.empty()) {
        const size_t comma = text.find(',');
        const OptionText part = text.substr(0, comma);
        text.remove_prefix(comma == OptionText::npos ? text.size() : comma + 1);
        const size_t equals = part.find('=');
        if (equals != OptionText::npos)
            keys.emplace_back(part.substr(0, equals), part.substr(equals + 1));
        else if (!keys.empty())
            keys.back().second += "," + std::string(part);
        else
            throw UsageError(fmt::format("{} has no value: write KEY=VALUE", inQuotes(std::string(part))));
    }
    return keys;
}

SceneEdit addOf(OptionText text) {
    const size_t comma = text.find(',');
    const std::string type(text.substr(0, comma));
    std::vector<Setting> settings;
    AddLightEdit light;
    const bool isSky = type == "sky";
    for (auto& [key, value] : keysOf(comma == OptionText::npos ? OptionText() : text.substr(comma + 1))) {
        if (!isSky && key == "position")
            light.position = pointOf(value);
        else if (!isSky && key == "rotation")
            light.rotation = pointOf(value);
        else if (!isSky && key == "aim")
            light.aim = pointOf(value);
        else
            settings.push_back(settingOf(requireProperty(key), value));
    }
    if (isSky) return AddSkyEdit{std::move(settings)};
    light.settings = std::move(settings);
    for (const LightType candidate :
         {LightType::Point, LightType::Spot, LightType::Directional, LightType::Rectangle, LightType::Disc}) {
        if (type != lightTypeName(candidate)) continue;
        light.type = candidate;
        return light;
    }
    throw UsageError(fmt::format("{} is no type: there is point, spot, directional, rectangle, disc and sky",
                                 inQuotes(type)));
}

DuplicateEdit duplicateOf(OptionText text, const char* form) {
    const size_t equals = text.rfind('=');
    if (equals == OptionText::npos) return {requireName(text, form), ""};
    return {requireName(text.substr(0, equals), form), requireName(text.substr(equals + 1), form)};
}

template<typename Kind, typename Action>
auto naming(const TypedEdit& typed, Action action) {
    try {
        return action();
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{} {}: {}", typed.option, inQuotes(typed.text), error.what()));
    } catch (const Error& error) {
        throw Kind(fmt::format("{} {}: {}", typed.option, inQuotes(typed.text), error.what()));
    }
}

} // namespace

void addEditOptions(CLI::App& command) {
    // Each takes one text and may come again; the command knows the order in which all came.
    for (const OptionRow& row : kOptions)
        command.add_option(row.option, row.help)
            ->type_name(row.form)
            ->expected(1)
            ->allow_extra_args(false)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->group("Edits, made in this order");
}

SceneEdit sceneEditOf(std::string_view option, std::string_view text) {
    const OptionRow* row = kOptions;
    while (option != row->option) {
        ++row;
        ASSERT(row != std::end(kOptions));
    }
    const auto pointed = [&] {
        const auto [name, point] = splitLast(text, row->form);
        return std::pair(requireName(name, row->form), pointOf(point));
    };
    if (option == "--set") return setOf(text, row->form);
    if (option == "--move") return moveOf(text, row->form);
    if (option == "--add") return addOf(text);
    if (option == "--duplicate") return duplicateOf(text, row->form);
    if (option == "--delete") return DeleteEdit{requireName(text, row->form)};
    if (option == "--hide" || option == "--show")
        return HideEdit{requireName(text, row->form), option == "--hide"};
    const auto [name, point] = pointed();
    if (option == "--aim") return AimEdit{name, point};
    return RotateEdit{name, point};
}

std::vector<TypedEdit> typedEdits(CLI::App& command) {
    std::vector<TypedEdit> edits;
    std::map<const CLI::Option*, size_t> taken;
    for (const CLI::Option* option : command.parse_order()) {
        const std::string name = option->get_name();
        const bool isEdit = std::any_of(std::begin(kOptions), std::end(kOptions),
                                        [&](const OptionRow& row) { return name == row.option; });
        if (!isEdit) continue;
        TypedEdit typed{name, option->results().at(taken[option]++), {}};
        typed.edit = naming<UsageError>(typed, [&] { return sceneEditOf(typed.option, typed.text); });
        edits.push_back(std::move(typed));
    }
    return edits;
}

std::vector<std::string> applyEdits(const Scene& scene, const std::vector<TypedEdit>& typed,
                                    SceneEdits& edits) {
    std::vector<std::string> done;
    for (const TypedEdit& edit : typed)
        done.push_back(naming<Error>(edit, [&] { return applyEdit(scene, edit.edit, edits); }));
    return done;
}

} // namespace relume
