#include "assets/gltf/edit/gltf_edit_json.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>

namespace relume::gltf {

namespace {

double rounded(double value, int digits) {
    char text[32]; // [sign]d.ddddddddde[sign]ddd
    const std::to_chars_result end =
        std::to_chars(text, text + sizeof(text), value, std::chars_format::scientific, digits - 1);
    std::from_chars(text, end.ptr, value);
    return value;
}

} // namespace

FileEdit::FileEdit(const File& source) : file(source), json(EditedJson::parse(jsonText(source))) {
    const std::string_view text = jsonText(source);
    for (const char* sign : {"KHR_animation_pointer", "KHR_interactivity", "\"/nodes/", "\"\\/nodes\\/",
                             "\"/extensions/", "\"\\/extensions\\/"})
        hasPointers = hasPointers || text.find(sign) != std::string_view::npos;
}

void FileEdit::fail(const std::string& what) const {
    throw Error(fmt::format("{}: {}: the file is damaged, export it again", file.path, what));
}

EditedJson* find(EditedJson& holder, const JsonPath& path) {
    EditedJson* place = &holder;
    for (const char* key : path) {
        if (!place->is_object()) return nullptr;
        const auto found = place->find(key);
        if (found == place->end()) return nullptr;
        place = &*found;
    }
    return place;
}

EditedJson& make(const FileEdit& edit, EditedJson& holder, const JsonPath& path, const std::string& where) {
    EditedJson* place = &holder;
    std::string name = where;
    for (const char* key : path) {
        if (!place->is_object() && !place->is_null())
            throw Error(fmt::format("{}: {} is no object, so that nothing can be kept in it: remove it from "
                                    "the file",
                                    edit.file.path, name));
        place = &(*place)[key];
        name += fmt::format("{}{}", name.empty() ? "" : ".", key);
    }
    return *place;
}

void erase(EditedJson& holder, const JsonPath& path) {
    if (!find(holder, path)) return;
    std::vector<EditedJson*> holders;
    EditedJson* place = &holder;
    for (const char* key : path) {
        holders.push_back(place);
        place = &(*place)[key];
    }
    for (size_t i = holders.size(); i-- > 0;) {
        holders[i]->erase(path[i]);
        if (!holders[i]->empty()) return;
    }
}

double shortest(double value, const std::function<bool(double)>& good) {
    constexpr int kFloatDigits = 9; // tell any two floats apart
    for (int digits = 1; digits <= kFloatDigits; ++digits) {
        const double candidate = rounded(value, digits);
        if (good(candidate)) return candidate;
    }
    return value;
}

EditedJson number(float value) {
    if (value == 0.0f) return 0.0; // not -0
    return shortest(value, [value](double v) { return static_cast<float>(v) == value; });
}

void setNumber(EditedJson& place, float value) {
    if (place.is_number() && static_cast<float>(place.get<double>()) == value) return;
    place = number(value);
}

void setNumbers(EditedJson& place, std::span<const float> values) {
    if (!place.is_array() || place.size() != values.size()) place = EditedJson(values.size(), nullptr);
    for (size_t i = 0; i < values.size(); ++i)
        setNumber(place[i], values[i]);
}

void useExtension(FileEdit& edit, const std::string& name) {
    EditedJson& used = edit.json["extensionsUsed"];
    if (used.is_null()) used = EditedJson::array();
    for (const EditedJson& entry : used)
        if (entry == name) return;
    used.push_back(name);
}

void dropExtension(FileEdit& edit, const std::string& name) {
    for (const char* section : {"extensionsUsed", "extensionsRequired"}) {
        EditedJson* names = find(edit.json, {section});
        if (!names) continue;
        for (size_t i = names->size(); i-- > 0;)
            if ((*names)[i] == name) names->erase(i);
        if (names->empty()) erase(edit.json, {section});
    }
}

} // namespace relume::gltf
