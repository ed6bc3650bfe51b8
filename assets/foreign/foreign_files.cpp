#include "assets/foreign/foreign_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLookedAt = 1024; // [bytes]; a document of COLLADA names its kind within them

std::string firstBytes(const std::string& path) {
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return ""; // reading a pipe would wait for its writer
    std::ifstream stream(path, std::ios::binary);
    std::string bytes(kLookedAt, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    return bytes;
}

bool beginsAsForeign(std::string_view bytes) {
    constexpr std::array<std::string_view, 5> kBegins = {"Kaydara FBX Binary", "; FBX ", "BLENDER", "ply\n",
                                                         "ply\r\n"};
    if (std::any_of(kBegins.begin(), kBegins.end(),
                    [&](std::string_view begin) { return bytes.starts_with(begin); }))
        return true;
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3); // a mark of UTF-8
    return bytes.starts_with("<?xml") && bytes.find("<COLLADA") != std::string_view::npos;
}

} // namespace

std::string lowerEnding(const std::string& path) {
    std::string ending = fs::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

const std::vector<std::string>& foreignEndings() {
    static const std::vector<std::string> endings = {
        ".obj", ".fbx", ".dae",  ".3ds", ".blend",   ".ply",  ".stl", ".off", ".x",   ".lwo", ".lws", ".lxo",
        ".ase", ".ac",  ".3mf",  ".amf", ".b3d",     ".cob",  ".dxf", ".ifc", ".iqm", ".pk3", ".md2", ".md3",
        ".mdl", ".hmp", ".ms3d", ".nff", ".md5mesh", ".ogex", ".smd", ".x3d", ".xgl", ".zae", ".zgl"};
    return endings;
}

std::string mendOf(const std::string& path) {
    return lowerEnding(path) == ".blend" ? "install Blender, by which it is read then, or export it as glTF"
                                         : "check the file, or export it as glTF";
}

bool isForeign(const std::string& path) {
    const std::string ending = lowerEnding(path);
    if (ending == ".glb" || ending == ".gltf") return false;
    const std::string bytes = firstBytes(path);
    if (bytes.starts_with("glTF")) return false;
    const std::vector<std::string>& endings = foreignEndings();
    return std::find(endings.begin(), endings.end(), ending) != endings.end() || beginsAsForeign(bytes);
}

} // namespace relume
