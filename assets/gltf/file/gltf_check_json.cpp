#include "assets/gltf/file/gltf_check_json.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace relume::gltf {

using nlohmann::json;

void JsonChecks::fail(const std::string& what) const {
    throw Error(fmt::format("{}: {}: the file is damaged, export it again", file_.path, what));
}

const json* JsonChecks::extension(const json& holder, const char* name, const std::string& where) const {
    const json* extensions = member(holder, "extensions");
    if (!extensions) return nullptr;
    const json* value = member(object(*extensions, where + ".extensions"), name);
    return value ? &object(*value, where + ".extensions." + name) : nullptr;
}

const json* JsonChecks::member(const json& object, const char* key) const {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

uint64_t JsonChecks::count(const char* section) const {
    const json* list = member(root_, section);
    return list ? list->size() : 0;
}

int64_t JsonChecks::integer(const json& object, const char* key, const std::string& where, int64_t fallback,
                            int64_t limit) const {
    const json* value = member(object, key);
    if (!value) return fallback;
    // The parser gives unsigned to whatever is not negative, so this also bounds 64-bit values.
    if (!value->is_number_unsigned() || value->get<uint64_t>() > static_cast<uint64_t>(limit))
        fail(fmt::format("{}.{} is {}, not an integer from 0 to {}", where, key, inQuotes(value->dump()),
                         limit));
    return value->get<int64_t>();
}

int64_t JsonChecks::size(const json& object, const char* key, const std::string& where,
                         int64_t fallback) const {
    return integer(object, key, where, fallback, int64_t(1) << 40);
}

int64_t JsonChecks::index(const json& object, const char* key, const std::string& where,
                          const char* section) const {
    const int64_t value = integer(object, key, where);
    const uint64_t entries = count(section);
    if (value >= 0 && static_cast<uint64_t>(value) >= entries)
        fail(fmt::format("{}.{} is {}, but there are {} {}", where, key, value, entries, section));
    return value;
}

void JsonChecks::numbers(const json& object, const char* key, const std::string& where, size_t length) const {
    const json* value = member(object, key);
    if (!value) return;
    const bool good = value->is_array() && value->size() == length &&
                      std::all_of(value->begin(), value->end(), [](const json& v) { return v.is_number(); });
    if (!good) fail(fmt::format("{}.{} is not an array of {} numbers", where, key, length));
}

void JsonChecks::number(const json& object, const char* key, const std::string& where) const {
    const json* value = member(object, key);
    if (value && !value->is_number()) fail(fmt::format("{}.{} is not a number", where, key));
}

void JsonChecks::text(const json& object, const char* key, const std::string& where) const {
    const json* value = member(object, key);
    if (value && !value->is_string()) fail(fmt::format("{}.{} is not a string", where, key));
}

const json& JsonChecks::object(const json& value, const std::string& where) const {
    if (!value.is_object()) fail(where + " is not an object");
    return value;
}

} // namespace relume::gltf
