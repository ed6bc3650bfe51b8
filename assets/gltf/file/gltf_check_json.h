#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

#include "assets/gltf/file/gltf_file.h"

namespace relume::gltf {

/// Looks into the JSON of a file that is not trusted yet. `where` names the object that is looked at in a
/// message. Whatever is of another type or out of range than glTF allows is an Error, which names file and
/// thing.
class JsonChecks {
public:
    explicit JsonChecks(const File& file) : file_(file), root_(file.json) {} // `file` must outlive it

    [[noreturn]] void fail(const std::string& what) const;
    const nlohmann::json* member(const nlohmann::json& object, const char* key) const;
    /// Returns an extension of an object, which is an object, or nullptr.
    const nlohmann::json* extension(const nlohmann::json& object, const char* name,
                                    const std::string& where) const;
    uint64_t count(const char* section) const;
    int64_t integer(const nlohmann::json& object, const char* key, const std::string& where,
                    int64_t fallback = -1, int64_t limit = std::numeric_limits<int32_t>::max()) const;
    /// Returns a member that names an entry of a section, -1 where there is none.
    int64_t index(const nlohmann::json& object, const char* key, const std::string& where,
                  const char* section) const;
    int64_t size(const nlohmann::json& object, const char* key, const std::string& where,
                 int64_t fallback) const;
    void numbers(const nlohmann::json& object, const char* key, const std::string& where,
                 size_t length) const;
    void number(const nlohmann::json& object, const char* key, const std::string& where) const;
    void text(const nlohmann::json& object, const char* key, const std::string& where) const;
    const nlohmann::json& object(const nlohmann::json& value, const std::string& where) const;

    const File& file() const { return file_; }
    const nlohmann::json& root() const { return root_; }

protected:
    const File& file_;
    const nlohmann::json& root_;
};

} // namespace relume::gltf
