#include "assets/foreign/foreign_scene.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/uri.h"
#include "assets/foreign/foreign_build.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/foreign_read.h"

#include <assimp/commonMetaData.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

namespace relume {

namespace foreign {

namespace {

// Blender's lights are in watts since this version.
constexpr double kFirstInWatts = 2.8;

/// Returns the version of Blender that a .blend file begins with, "BLENDER-v279", or 0.
double blendVersion(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string head(12, '\0');
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    return stream && head.starts_with("BLENDER") ? std::atoi(head.c_str() + 9) / 100.0 : 0.0;
}

/// Returns the first number behind "Blender" in what a file says of its maker, or 0.
double versionIn(const std::string& text) {
    const size_t name = text.find("Blender");
    const size_t digit =
        name == std::string::npos ? std::string::npos : text.find_first_of("0123456789", name);
    return digit == std::string::npos ? 0.0 : std::strtod(text.c_str() + digit, nullptr);
}

/// Returns the first line of a file, or what fits into a sane one.
std::string firstLine(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string head(256, '\0');
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<size_t>(stream.gcount()));
    return head.substr(0, head.find('\n'));
}

/// Tells whether the lights and the emission of the file are in watts, because Blender wrote it.
bool isInWatts(const Build& build) {
    if (build.ending == ".blend") return blendVersion(build.path) >= kFirstInWatts;
    // libassimp does not hand on the comment that tells who has written an .obj file: "# Blender v2.93.1
    // OBJ".
    if (build.ending == ".obj") {
        const std::string line = firstLine(build.path);
        return line.starts_with("# Blender") && versionIn(line) >= kFirstInWatts;
    }
    aiString generator;
    const aiMetadata* data = build.source->mMetaData;
    if (!data || !data->Get(AI_METADATA_SOURCE_GENERATOR, generator)) return false;
    return versionIn(std::string(generator.data, generator.length)) >= kFirstInWatts;
}

void warnUnsupported(Build& build, const Reader& reader) {
    if (reader.animated()) build.warnings.add("animations", "are not supported, the scene stands as stored");
    if (reader.skinned()) build.warnings.add("skins", "are not supported, the meshes stand as stored");
    if (reader.skippedPoints()) build.warnings.add("points and lines", "have no area, left out");
    for (const std::string& library : reader.missingLibraries())
        build.warnings.add(
            "the material library " + inQuotes(library),
            "is not in the folder of the file or near it, its materials are grey: put it there");
}

} // namespace

std::string nameOf(const aiString& name) {
    const std::string text(name.data, std::min<size_t>(name.length, sizeof(name.data) - 1));
    if (isUtf8(text)) return text;
    std::string utf8;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            utf8 += c;
        } else {
            utf8 += static_cast<char>(0xc0 | byte >> 6);
            utf8 += static_cast<char>(0x80 | (byte & 0x3f));
        }
    }
    return utf8;
}

} // namespace foreign

ForeignScene convertForeign(const std::string& path, const ForeignChoice& choice,
                            const ForeignProgress& progress) {
    RegularFile(path, "name a file with a scene"); // it is there and can be read
    foreign::Build build(path);
    build.ending = lowerEnding(path);
    build.choice = choice;
    foreign::Reader reader(build.near, progress);
    build.source = &reader.read(path);
    build.inWatts = foreign::isInWatts(build);
    build.made.scene.path = path;
    foreign::warnUnsupported(build, reader);
    foreign::buildMaterials(build);
    foreign::buildNodes(build);
    if (build.made.scene.instances.empty())
        throw Error(
            fmt::format("{}: has no mesh with triangles in its scene: export it with its geometry", path));
    build.made.scene.warnings = build.warnings.lines(path);
    return std::move(build.made);
}

} // namespace relume
