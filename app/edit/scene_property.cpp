#include "app/edit/scene_property.h"

#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/images/float_image.h"
#include "assets/model/black_body.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace relume {
namespace {

constexpr float kMostNumber = std::numeric_limits<float>::max();
// A cone of 0 lights nothing; this one [degrees], which is the importer's, lights a metre at 1 km.
constexpr float kNarrowestCone = 0.0573f;

enum class ValueKind { Number, Pair, Color, Radiance, Text };

struct PropertyRow {
    const char* name;
    Property property;
    ValueKind kind;
    float least, most;
    const char* mend; // the remedy: which values there are
};

constexpr std::array kRows = {
    PropertyRow{"name", Property::Name, ValueKind::Text, 0, 0, "give a text"},
    PropertyRow{"intensity", Property::Intensity, ValueKind::Number, 0, kBrightest,
                "give a number from 0 to 1e12"},
    PropertyRow{"color", Property::Color, ValueKind::Color, 0, 1,
                "give #rrggbb or r,g,b from 0 to 1, and what is brighter by the intensity"},
    PropertyRow{"temperature", Property::Temperature, ValueKind::Number, kLowestTemperature,
                kHighestTemperature, "give kelvins from 1000 to 15000"},
    PropertyRow{"radius", Property::Radius, ValueKind::Number, 0, kFarthest, "give metres from 0 to 1e8"},
    PropertyRow{"angle", Property::Angle, ValueKind::Number, 0, 180, "give degrees from 0 to 180"},
    PropertyRow{"size", Property::Size, ValueKind::Pair, 0, kFarthest,
                "give width,height in metres above 0, up to 1e8"},
    PropertyRow{"range", Property::Range, ValueKind::Number, 0, kMostNumber,
                "give metres, or 0 for no limit"},
    PropertyRow{"inner", Property::Inner, ValueKind::Number, 0, 90,
                "give degrees from 0 to the outer cone's"},
    PropertyRow{"outer", Property::Outer, ValueKind::Number, kNarrowestCone, 90,
                "give degrees from the axis, from 0.0573 to 90"},
    PropertyRow{"strength", Property::Strength, ValueKind::Number, 0, kBrightest,
                "give cd/m^2 from 0 to 1e12"},
    PropertyRow{"baseColor", Property::BaseColor, ValueKind::Color, 0, 1,
                "give #rrggbb or r,g,b from 0 to 1"},
    PropertyRow{"emission", Property::Emission, ValueKind::Radiance, 0, kBrightest,
                "give r,g,b in cd/m^2 from 0 to 1e12"},
    PropertyRow{"rotation", Property::Rotation, ValueKind::Number, -kMostNumber, kMostNumber, "give degrees"},
    PropertyRow{"file", Property::File, ValueKind::Text, 0, 0, "name an .exr or .hdr file"},
    PropertyRow{"density", Property::Density, ValueKind::Number, kLeastDensity, kMostDensity,
                "give a factor on the texels per metre, from 0.01 to 100"},
};

const PropertyRow& rowOf(Property property) {
    return *std::find_if(kRows.begin(), kRows.end(),
                         [property](const PropertyRow& row) { return row.property == property; });
}

std::optional<glm::vec3> hexColor(std::string_view text) {
    uint32_t rgb = 0;
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, rgb, 16);
    if (error != std::errc() || end != text.data() + 7) return std::nullopt;
    const auto channel = [rgb](int shift) { return float(linearFromSrgb((rgb >> shift & 255u) / 255.0)); };
    return glm::vec3(channel(16), channel(8), channel(0));
}

bool within(const PropertyRow& row, float value) {
    return std::isfinite(value) && value >= row.least && value <= row.most;
}

} // namespace

const char* propertyName(Property property) {
    return rowOf(property).name;
}

std::optional<Property> propertyOf(std::string_view name) {
    for (const PropertyRow& row : kRows)
        if (row.name == name) return row.property;
    return std::nullopt;
}

std::string propertyNames() {
    std::string names;
    for (const PropertyRow& row : kRows)
        names += std::string(names.empty() ? "" : ", ") + row.name;
    return names;
}

Setting settingOf(Property property, std::string_view text) {
    const PropertyRow& row = rowOf(property);
    const size_t counts[] = {1, 2, 3, 3};
    if (row.kind == ValueKind::Text) return {property, std::string(text)};
    if (row.kind == ValueKind::Color)
        if (const std::optional<glm::vec3> color = hexColor(text)) return {property, *color};
    const std::vector<float> numbers = typedNumbers(text, counts[size_t(row.kind)]);
    if (numbers.empty())
        throw UsageError(fmt::format("{} is no {} of finite numbers: {}", inQuotes(std::string(text)),
                                     row.name, row.mend));
    if (row.kind == ValueKind::Number) return {property, numbers[0]};
    if (row.kind == ValueKind::Pair) return {property, glm::vec2(numbers[0], numbers[1])};
    return {property, glm::vec3(numbers[0], numbers[1], numbers[2])};
}

void requireGood(const Setting& setting) {
    const PropertyRow& row = rowOf(setting.property);
    const auto require = [&](bool good) {
        if (!good) throw UsageError(fmt::format("{} is out of range: {}", describe(setting), row.mend));
    };
    if (row.kind == ValueKind::Text) {
        require(!std::get<std::string>(setting.value).empty() || setting.property == Property::File);
    } else if (row.kind == ValueKind::Number) {
        require(within(row, std::get<float>(setting.value)));
    } else if (row.kind == ValueKind::Pair) {
        const glm::vec2 pair = std::get<glm::vec2>(setting.value);
        require(within(row, pair.x) && within(row, pair.y) && pair.x > 0.0f && pair.y > 0.0f);
    } else {
        const glm::vec3 rgb = std::get<glm::vec3>(setting.value);
        require(within(row, rgb.r) && within(row, rgb.g) && within(row, rgb.b));
    }
}

std::string describe(const Setting& setting) {
    const std::string name = propertyName(setting.property);
    if (const auto* text = std::get_if<std::string>(&setting.value)) return name + " " + inQuotes(*text);
    if (const auto* number = std::get_if<float>(&setting.value))
        return fmt::format("{} {:.6g}", name, *number);
    if (const auto* pair = std::get_if<glm::vec2>(&setting.value))
        return fmt::format("{} {:.6g},{:.6g}", name, pair->x, pair->y);
    const glm::vec3 v = std::get<glm::vec3>(setting.value);
    return fmt::format("{} {:.4g},{:.4g},{:.4g}", name, v.x, v.y, v.z);
}

} // namespace relume
