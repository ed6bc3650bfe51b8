#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <glm/glm.hpp>

namespace relume {

/// The properties of analytic lights, mesh lights, materials, objects and the sky that edits can set.
enum class Property {
    Name,
    Intensity,   // [cd, lux, cd/m^2]
    Color,       // linear, each channel from 0 to 1
    Temperature, // of a black body that gives the colour [K]
    Radius,      // [m]
    Angle,       // across the sun's disc [degrees]
    Size,        // of a rectangle along X and Y [m]
    Range,       // [m], 0: infinite
    Inner,       // cones, from the axis [degrees]
    Outer,
    Strength,  // of an emission, its brightest channel [cd/m^2]
    BaseColor, // linear, each channel from 0 to 1
    Emission,  // [cd/m^2]
    Rotation,  // of the sky's picture about +Y [degrees]
    File,      // path of the sky's picture
    Density,   // of an object, factor on the texels per metre of an unwrap
};

using PropertyValue = std::variant<float, glm::vec2, glm::vec3, std::string>;

struct Setting {
    Property property{};
    PropertyValue value; // of the type that the property has, see settingOf
};

/// Returns the name as users type it: "intensity", "baseColor".
const char* propertyName(Property property);
std::optional<Property> propertyOf(std::string_view name);
/// Returns the names of all, "name, intensity, ...".
std::string propertyNames();

/// Returns the setting that `text` means: a number; "w,h"; for colours "r,g,b" (linear) or "#rrggbb" (sRGB,
/// as editors show colours); for names and files the text itself. Throws UsageError, "'x' is no number: ...".
Setting settingOf(Property property, std::string_view text);

/// Throws UsageError where a value is not finite or out of the property's range; it says which values there
/// are.
void requireGood(const Setting& setting);

/// Returns the setting as it is typed.
std::string describe(const Setting& setting);

} // namespace relume
