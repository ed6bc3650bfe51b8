#include "assets/gltf/file/gltf_links.h"

#include "assets/base/uri.h"
#include "assets/gltf/file/gltf_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;
using LinksJson = nlohmann::json;

constexpr int kMostLevels = 64; // as those who load it allow

// Returns the JSON of the file; of a GLB, only the first chunk is read, since the rest may be gigabytes.
std::string jsonOfFile(const std::string& path) {
    constexpr size_t kHeader = 20;
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return "";
    const uint64_t size = fs::file_size(path, code);
    std::ifstream stream(path, std::ios::binary);
    std::string text(kHeader, '\0');
    stream.read(text.data(), kHeader);
    if (code || !stream) return "";
    uint64_t begin = 0, bytes = size;
    if (text.starts_with("glTF")) {
        uint32_t length = 0;
        std::memcpy(&length, text.data() + 12, sizeof(length));
        begin = kHeader;
        bytes = length;
    }
    if (begin + bytes > size) return "";
    text.resize(bytes);
    stream.seekg(static_cast<std::streamoff>(begin));
    stream.read(text.data(), static_cast<std::streamsize>(bytes));
    return stream ? text : "";
}

void addUris(const LinksJson& value, int levels, std::vector<std::string>& uris) {
    if (levels == 0 || !value.is_structured()) return;
    for (auto member = value.begin(); member != value.end(); ++member) {
        if (value.is_object() && member.key() == "extras") continue; // known to their owner alone
        if (value.is_object() && member.key() == "uri" && member->is_string())
            uris.push_back(member->get<std::string>());
        else
            addUris(*member, levels - 1, uris);
    }
}

} // namespace

std::vector<std::string> linkedFiles(const std::string& path) {
    const std::string text = jsonOfFile(path);
    if (text.find("\"uri\"") == std::string::npos && text.find("\"relume\"") == std::string::npos) return {};
    const LinksJson json = LinksJson::parse(text, nullptr, false);
    if (!json.is_object()) return {};
    std::vector<std::string> uris, files;
    addUris(json, kMostLevels, uris);
    const fs::path folder = fs::path(path).parent_path();
    for (const std::string& uri : uris) {
        if (!isRelativeUri(uri) && !uri.starts_with('/')) continue;
        files.push_back((folder / decodedUri(uri)).string());
    }
    const auto scenes = json.find("scenes");
    if (scenes == json.end() || !scenes->is_array()) return files;
    for (const LinksJson& scene : *scenes) {
        const LinksJson* sky = gltf::ownExtra(scene, "sky");
        if (!sky || !sky->is_object()) continue;
        const auto file = sky->find("file");
        if (file != sky->end() && file->is_string())
            files.push_back((folder / file->get<std::string>()).string());
    }
    return files;
}

} // namespace relume
