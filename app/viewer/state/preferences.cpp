#include "app/viewer/state/preferences.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/file_write.h"
#include "assets/base/log.h"
#include "assets/base/uri.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Reads fields of an object; those of another type, and those out of range, are left out and counted.
class Reader {
public:
    Reader(const Json& json, int& wrong) : json_(json), wrong_(wrong) {}

    void number(const char* name, float& value, float least, float most) const {
        const Json* found = find(name);
        if (found == nullptr) return;
        const double read = found->is_number() ? found->get<double>() : NAN;
        take(read >= least && read <= most, [&] { value = static_cast<float>(read); });
    }
    void number(const char* name, uint32_t& value, uint32_t least, uint32_t most) const {
        const Json* found = find(name);
        if (found == nullptr) return;
        const double read = found->is_number_unsigned() ? found->get<double>() : -1.0;
        take(read >= least && read <= most, [&] { value = static_cast<uint32_t>(read); });
    }
    void flag(const char* name, bool& value) const {
        const Json* found = find(name);
        if (found != nullptr) take(found->is_boolean(), [&] { value = found->get<bool>(); });
    }
    void text(const char* name, std::string& value) const {
        const Json* found = find(name);
        if (found != nullptr) take(found->is_string(), [&] { value = found->get<std::string>(); });
    }
    void point(const char* name, glm::vec3& value) const {
        const Json* found = find(name);
        if (found == nullptr) return;
        const bool good = found->is_array() && found->size() == 3 &&
                          std::all_of(found->begin(), found->end(),
                                      [](const Json& element) { return element.is_number(); });
        take(good, [&] {
            value = {(*found)[0].get<float>(), (*found)[1].get<float>(), (*found)[2].get<float>()};
        });
    }
    /// Reads an enumerator by its name.
    template<typename T>
    void choice(const char* name, T& value, const std::vector<std::string>& names) const {
        std::string read;
        text(name, read);
        if (read.empty()) return;
        const auto found = std::find(names.begin(), names.end(), read);
        take(found != names.end(), [&] { value = static_cast<T>(found - names.begin()); });
    }
    const Json* find(const char* name) const {
        const auto found = json_.is_object() ? json_.find(name) : json_.end();
        return found != json_.end() ? &*found : nullptr;
    }
    template<typename F>
    void take(bool good, const F& set) const {
        if (good)
            set();
        else
            ++wrong_;
    }

private:
    const Json& json_;
    int& wrong_;
};

constexpr std::string_view kFileUri = "file://";

// Returns a path as JSON can hold it: one that is not UTF-8 becomes a URI.
std::string storedPath(const std::string& path) {
    return isUtf8(path) ? path : std::string(kFileUri) + encodedUri(path);
}

std::string pathOf(const std::string& stored) {
    return stored.starts_with(kFileUri) ? decodedUri(std::string_view(stored).substr(kFileUri.size()))
                                        : stored;
}

Json point(const glm::vec3& p) {
    return {p.x, p.y, p.z};
}

Json writeBookmark(const Bookmark& mark) {
    const ViewCamera& camera = mark.camera;
    return {{"name", mark.name},      {"eye", point(camera.eye)}, {"target", point(camera.target)},
            {"up", point(camera.up)}, {"yfov", camera.yfov},      {"halfHeight", camera.halfHeight},
            {"znear", camera.znear},  {"zfar", camera.zfar}};
}

// Reads a bookmark. Returns nothing where it has no usable camera.
std::optional<Bookmark> readBookmark(const Json& json, int& wrong) {
    constexpr float kFar = 1e30f;
    const Reader reader(json, wrong);
    Bookmark mark;
    ViewCamera& camera = mark.camera;
    const int before = wrong;
    reader.text("name", mark.name);
    reader.point("eye", camera.eye);
    reader.point("target", camera.target);
    reader.point("up", camera.up);
    reader.number("yfov", camera.yfov, 1e-3f, 3.1f);
    reader.number("halfHeight", camera.halfHeight, 0.0f, kFar);
    reader.number("znear", camera.znear, 1e-30f, kFar);
    reader.number("zfar", camera.zfar, 1e-30f, kFar);
    const float sum = glm::length(camera.eye) + glm::length(camera.target) + glm::length(camera.up);
    const bool usable = !mark.name.empty() && std::isfinite(sum) && camera.eye != camera.target &&
                        glm::length(camera.up) > 0.0f;
    // A vector of unit length but for rounding stays as it is: otherwise each file would have other digits
    // than the one before.
    const float length = glm::length(camera.up);
    reader.take(usable, [&] {
        if (std::abs(length - 1.0f) > 1e-6f) camera.up = glm::normalize(camera.up);
    });
    return wrong == before ? std::optional(mark) : std::nullopt;
}

void readBookmarks(const Json& json, Preferences& preferences, int& wrong) {
    for (const auto& [scene, list] : json.items())
        for (const Json& entry : list) {
            const std::optional<Bookmark> mark = readBookmark(entry, wrong);
            if (mark) preferences.bookmarks[pathOf(scene)].push_back(*mark);
        }
}

Json toJson(const Preferences& p) {
    Json json = {{"window", {{"width", p.width}, {"height", p.height}}},
                 {"panelWidth", p.panelWidth},
                 {"uiScale", p.uiScale},
                 {"vsync", p.vsync},
                 {"caption", p.caption},
                 {"filter", filterNames()[static_cast<size_t>(p.filter)]},
                 {"tone", toneNames()[static_cast<size_t>(p.tone)]},
                 {"captureFolder", storedPath(p.captureFolder)},
                 {"recent", Json::array()}};
    for (const std::string& path : p.recent)
        json["recent"].push_back(storedPath(path));
    if (p.samples) json["samples"] = *p.samples;
    json["bookmarks"] = Json::object();
    for (const auto& [scene, marks] : p.bookmarks)
        for (const Bookmark& mark : marks)
            json["bookmarks"][storedPath(scene)].push_back(writeBookmark(mark));
    return json;
}

} // namespace

std::string Preferences::addBookmark(const std::string& scene, const ViewCamera& camera) {
    std::vector<Bookmark>& marks = bookmarks[scene];
    const auto taken = [&](const std::string& name) {
        return std::any_of(marks.begin(), marks.end(),
                           [&](const Bookmark& mark) { return mark.name == name; });
    };
    size_t number = marks.size() + 1;
    while (taken(fmt::format("bookmark {}", number)))
        ++number;
    marks.push_back({fmt::format("bookmark {}", number), camera});
    return marks.back().name;
}

void Preferences::addRecent(const std::string& path) {
    std::error_code code;
    const std::filesystem::path whole = std::filesystem::absolute(path, code);
    pushRecent(code ? path : whole.lexically_normal().string());
}

void Preferences::pushRecent(const std::string& path) {
    const std::string name = path; // which may be one of the list's
    std::erase(recent, name);
    recent.insert(recent.begin(), name);
    if (recent.size() > kMostRecent) recent.resize(kMostRecent);
}

glm::uvec2 rememberedWindow(const glm::uvec2& pixels, float contentScale) {
    const auto edge = [&](uint32_t value) {
        const float asked = contentScale > 0 ? static_cast<float>(value) / contentScale : 0.0f;
        return static_cast<uint32_t>(std::lround(
            std::clamp(asked, static_cast<float>(kLeastWindowEdge), static_cast<float>(kMostWindowEdge))));
    };
    return {edge(pixels.x), edge(pixels.y)};
}

std::string preferencesPath() {
    const char* config = std::getenv("XDG_CONFIG_HOME");
    const char* home = std::getenv("HOME");
    // The XDG base directory specification says that a relative path is to be ignored.
    if (config != nullptr && config[0] == '/') return std::string(config) + "/relume/preferences.json";
    if (home != nullptr && home[0] == '/') return std::string(home) + "/.config/relume/preferences.json";
    return "";
}

std::string absolutePath(const std::string& path) {
    std::error_code code;
    const std::filesystem::path whole = std::filesystem::absolute(path, code);
    return code ? path : whole.lexically_normal().string();
}

std::string defaultCaptureFolder() {
    const char* home = std::getenv("HOME");
    std::error_code code;
    if (home != nullptr && fs::is_directory(std::string(home) + "/Pictures", code))
        return std::string(home) + "/Pictures/relume";
    return ".";
}

std::optional<Preferences> findPreferences(const std::string& path) {
    if (const std::string kind = oddKindOf(path); !kind.empty()) { // reading a pipe would wait
        spdlog::warn("{}: {}: all settings keep their defaults", path, kind);
        return std::nullopt;
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    std::ostringstream bytes;
    bytes << file.rdbuf();
    const Json json = Json::parse(bytes.str(), nullptr, false);
    if (!json.is_object()) {
        spdlog::warn("{}: is no JSON object: all settings keep their defaults", path);
        return std::nullopt;
    }
    Preferences preferences;
    int wrong = 0;
    const Reader reader(json, wrong);
    if (const Json* window = reader.find("window")) {
        const Reader edges(*window, wrong);
        edges.number("width", preferences.width, kLeastWindowEdge, kMostWindowEdge);
        edges.number("height", preferences.height, kLeastWindowEdge, kMostWindowEdge);
    }
    reader.number("panelWidth", preferences.panelWidth, 100.0f, 4000.0f);
    reader.number("uiScale", preferences.uiScale, 0.5f, 4.0f);
    reader.flag("vsync", preferences.vsync);
    reader.flag("caption", preferences.caption);
    reader.choice("filter", preferences.filter, filterNames());
    reader.choice("tone", preferences.tone, toneNames());
    reader.text("captureFolder", preferences.captureFolder);
    preferences.captureFolder = pathOf(preferences.captureFolder);
    if (reader.find("samples") != nullptr) {
        uint32_t samples = 0;
        const int before = wrong;
        reader.number("samples", samples, 0, 64);
        if (wrong == before) preferences.samples = samples;
    }
    if (const Json* recent = reader.find("recent"); recent != nullptr && recent->is_array()) {
        for (const Json& entry : *recent)
            if (entry.is_string() && preferences.recent.size() < Preferences::kMostRecent)
                preferences.recent.push_back(pathOf(entry.get<std::string>()));
    }
    if (const Json* bookmarks = reader.find("bookmarks"); bookmarks != nullptr && bookmarks->is_object())
        readBookmarks(*bookmarks, preferences, wrong);
    if (wrong > 0) spdlog::warn("{}: {} entries cannot be read and keep their defaults", path, wrong);
    return preferences;
}

Preferences readPreferences(const std::string& path) {
    return findPreferences(path).value_or(Preferences{});
}

void writePreferences(const std::string& path, const Preferences& preferences) {
    std::error_code code;
    fs::create_directories(fs::path(path).parent_path(), code);
    if (code) throw Error(path + ": its folder cannot be made: " + code.message() + ": set XDG_CONFIG_HOME");
    // Names of bookmarks may hold what is not UTF-8, which is replaced.
    writeFileAtomically(path, toJson(preferences).dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
                        OnFailure::Drop);
}

} // namespace relume
