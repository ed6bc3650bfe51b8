// Arrays with an element or more per patch may be larger than 4 GiB, and a GPU's driver may compute the
// offset of items[index] with 32 bits: light of a lightmap of 90 million patches was wrong then. No software
// device shows it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace relume {
namespace {

namespace fs = std::filesystem;

// These read arrays of bits and senders, for all pairs of patches, of which there are never so many, or
// textures.
const std::set<std::string> kSmallArrays = {"lib/buffers.glsl", "lib/rays/masked.glsl",
                                            "lib/rays/occlusion.glsl", "lib/supers.glsl", "lib/senders.glsl"};

// Returns the lines of a shader that index such an array without 64 bits.
std::string shortOffsets(const std::string& source) {
    static const std::regex kIndexed(R"(\b(Vec4s|UVec2s|Words|Floats)\(.*\)\.items\[(?!0\]))");
    std::istringstream stream(source);
    std::string line, found;
    while (std::getline(stream, line))
        if (std::regex_search(line, kIndexed)) found += line + "\n";
    return found;
}

} // namespace

TEST(ShaderSources, IndexLargeArraysBy64Bits) {
    const fs::path folder = fs::path(RELUME_SOURCE_DIR) / "shaders";
    size_t looked = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = fs::relative(entry.path(), folder).string();
        const bool shader = name.ends_with(".glsl") || name.ends_with(".comp");
        if (!shader || name.starts_with("pairs/") || kSmallArrays.contains(name)) continue;
        std::ifstream file(entry.path());
        std::stringstream text;
        text << file.rdbuf();
        EXPECT_EQ(shortOffsets(text.str()), "")
            << name << ": use VEC4_AT, UVEC2_AT, WORD_AT or FLOAT_AT of lib/buffers.glsl";
        ++looked;
    }
    EXPECT_GT(looked, 40u);
}

TEST(ShaderSources, WhatIndexesThemBy32BitsIsFound) {
    EXPECT_NE(shortOffsets("vec3 l = Vec4s(push.light).items[q * push.patchCount + i].rgb;"), "");
    EXPECT_EQ(shortOffsets("vec3 l = VEC4_AT(push.light, q * push.patchCount + i).rgb;"), "");
    EXPECT_EQ(shortOffsets("uint count = Words(push.list).items[0];"), "");
}

} // namespace relume
