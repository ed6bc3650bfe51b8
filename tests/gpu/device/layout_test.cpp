// Every struct of shaders/shared*.h lies in memory as C++ has it: a kernel made from the file's own text
// reads element 1 of an array of each and writes its members out, word by word.
#include "bake/base/shader_types.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"
#include "shaders/shader_compiler.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <sstream>

namespace relume {

namespace {

const std::string kShaderFolder = RELUME_SOURCE_DIR "/shaders";

struct Member {
    std::string type, name;
};
struct Struct {
    std::string name;
    std::vector<Member> members;
};

// Reads names and single signs and leaves comments out.
std::vector<std::string> readTokens(const std::string& path) {
    std::ifstream file(path);
    std::vector<std::string> tokens;
    for (std::string line; std::getline(file, line);) {
        line.resize(std::min(line.find("//"), line.size()));
        bool inName = false;
        for (char c : line) {
            const bool nameSign = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
            if (nameSign && inName) tokens.back() += c;
            if (nameSign && !inName) tokens.emplace_back(1, c);
            if (!nameSign && c != ' ') tokens.emplace_back(1, c);
            inName = nameSign;
        }
    }
    return tokens;
}

std::vector<Struct> readStructs() {
    std::vector<std::string> tokens;
    for (const char* file : {"/shared.h", "/shared_links.h", "/shared_layers.h"}) {
        const std::vector<std::string> more = readTokens(kShaderFolder + file);
        tokens.insert(tokens.end(), more.begin(), more.end());
    }
    std::vector<Struct> structs;
    for (size_t i = 0; i + 2 < tokens.size(); ++i) {
        if (tokens[i] != "struct") continue;
        Struct entry{tokens[i + 1], {}};
        for (i += 3; i < tokens.size() && tokens[i] != "}"; ++i) { // each turn: type name, name, ... ;
            const std::string type = tokens[i];
            for (++i; i < tokens.size() && tokens[i] != ";"; ++i)
                if (tokens[i] == "[") { // links[4]: a member each
                    const std::string name = entry.members.back().name;
                    entry.members.back().name += "[0]";
                    for (int k = 1; k < std::stoi(tokens[i + 1]); ++k)
                        entry.members.push_back({type, name + "[" + std::to_string(k) + "]"});
                    i += 2;
                } else if (tokens[i] != ",") {
                    entry.members.push_back({type, tokens[i]});
                }
        }
        structs.push_back(entry);
    }
    return structs;
}

#define SIZE_OF(name)                                                                                        \
    { #name, sizeof(shader::name) }
const std::map<std::string, size_t> kSizes = {SIZE_OF(VoxelGrid),
                                              SIZE_OF(CvmPush),
                                              SIZE_OF(Patch),
                                              SIZE_OF(PatchEdges),
                                              SIZE_OF(PatchCover),
                                              SIZE_OF(ChunkBounds),
                                              SIZE_OF(HitTriangle),
                                              SIZE_OF(AlphaTriangle),
                                              SIZE_OF(AlphaMaterial),
                                              SIZE_OF(BvhNode),
                                              SIZE_OF(BvhTriangle),
                                              SIZE_OF(TraceGeometry),
                                              SIZE_OF(OcclusionPush),
                                              SIZE_OF(ClosestPush),
                                              SIZE_OF(TransposePush),
                                              SIZE_OF(PublishPush),
                                              SIZE_OF(GatherPush),
                                              SIZE_OF(ReducePush),
                                              SIZE_OF(RadiancePush),
                                              SIZE_OF(FinishPush),
                                              SIZE_OF(CitPush),
                                              SIZE_OF(CitMaterial),
                                              SIZE_OF(SegmentPush),
                                              SIZE_OF(EmitterPolygon),
                                              SIZE_OF(EmitterNode),
                                              SIZE_OF(EmitterEdge),
                                              SIZE_OF(LinkPush),
                                              SIZE_OF(PackPush),
                                              SIZE_OF(DirectPush),
                                              SIZE_OF(EmitterSamplesPush),
                                              SIZE_OF(ComposePush),
                                              SIZE_OF(CarryPush),
                                              SIZE_OF(ChangePush),
                                              SIZE_OF(ResolveSums),
                                              SIZE_OF(SmoothPush),
                                              SIZE_OF(LocalSums),
                                              SIZE_OF(LinkDistancePush),
                                              SIZE_OF(PyramidNode),
                                              SIZE_OF(PyramidPush),
                                              SIZE_OF(FootprintPush),
                                              SIZE_OF(SuperBlock),
                                              SIZE_OF(Sender),
                                              SIZE_OF(CoarseTaps),
                                              SIZE_OF(InterpolatePush),
                                              SIZE_OF(CoarseNeighbours),
                                              SIZE_OF(CoarseErrorPush),
                                              SIZE_OF(Lamp),
                                              SIZE_OF(LampPush),
                                              SIZE_OF(LayerDirectPush),
                                              SIZE_OF(LayerResultPush),
                                              SIZE_OF(LayerWeight),
                                              SIZE_OF(SketchPush),
                                              SIZE_OF(LayerMixPush),
                                              SIZE_OF(BounceLane),
                                              SIZE_OF(LayerWorthPush),
                                              SIZE_OF(LayerLocalPush),
                                              SIZE_OF(BouncePush),
                                              SIZE_OF(ChunkSumPush)};
#undef SIZE_OF

// Appends the byte offsets of a struct's 32-bit words by C++'s rules: addresses lie at multiples of 8, all
// else at multiples of 4.
size_t appendWords(const std::vector<Struct>& structs, const Struct& entry, size_t offset,
                   std::vector<size_t>& words) {
    static const std::map<std::string, size_t> sizes = {
        {"float", 1}, {"int", 1},   {"uint", 1},  {"vec2", 2},  {"vec3", 3},
        {"vec4", 4},  {"uvec2", 2}, {"uvec3", 3}, {"uvec4", 4}, {"ADDRESS", 2}};
    for (const Member& member : entry.members) {
        const auto size = sizes.find(member.type);
        if (size == sizes.end()) {
            const auto nested = std::find_if(structs.begin(), structs.end(),
                                             [&](const Struct& s) { return s.name == member.type; });
            if (nested == structs.end()) throw Error("shared.h: unknown type " + member.type);
            offset = (offset + 7) / 8 * 8; // the only nested one begins with an address
            offset = appendWords(structs, *nested, offset, words);
            continue;
        }
        if (member.type == "ADDRESS") offset = (offset + 7) / 8 * 8;
        for (size_t i = 0; i < size->second; ++i, offset += 4)
            words.push_back(offset);
    }
    return offset;
}

std::string kernelFor(const std::vector<Struct>& structs, const std::string& name) {
    std::ostringstream text;
    text << R"(#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "shared.h"
layout(local_size_x = 1) in;
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Items { )"
         << name << R"( items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint items[]; };
layout(push_constant, scalar) uniform Push { uint64_t source, result; } push;
uint cursor = 0u;
void put(uint x) { Words(push.result).items[cursor++] = x; }
void put(int x) { put(uint(x)); }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec2 v) { put(v.x); put(v.y); }
void put(vec3 v) { put(v.xy); put(v.z); }
void put(vec4 v) { put(v.xyz); put(v.w); }
void put(uvec2 v) { put(v.x); put(v.y); }
void put(uvec3 v) { put(v.x); put(v.y); put(v.z); }
void put(uvec4 v) { put(v.x); put(v.y); put(v.z); put(v.w); }
void put(uint64_t x) { put(uint(x & 0xffffffffUL)); put(uint(x >> 32)); }
)";
    for (const Struct& entry : structs) {
        text << "void put(" << entry.name << " s) {";
        for (const Member& member : entry.members)
            text << " put(s." << member.name << ");";
        text << " }\n";
    }
    text << "void main() { put(Items(push.source).items[1]); }\n";
    return text.str();
}

} // namespace

TEST(SharedLayout, EveryStructIsListedHere) {
    const std::vector<Struct> structs = readStructs();
    EXPECT_EQ(structs.size(), kSizes.size());
    for (const Struct& entry : structs)
        EXPECT_TRUE(kSizes.contains(entry.name)) << entry.name;
}

TEST(SharedLayout, MembersRoundTripThroughTheGpu) {
    const vk::Device& device = testDevice();
    const std::vector<Struct> structs = readStructs();
    ASSERT_FALSE(structs.empty());
    for (const Struct& entry : structs) {
        const size_t size = kSizes.at(entry.name);
        std::vector<size_t> offsets;
        const size_t end = appendWords(structs, entry, 0, offsets);
        EXPECT_LE(end, size) << entry.name;
        EXPECT_LT(size, end + 8) << entry.name; // nothing but a tail to a multiple of 8

        std::vector<uint32_t> source(size / 4 * 2);
        for (uint32_t i = 0; i < source.size(); ++i)
            source[i] = 0x3f000000u + i; // ordinary floats, all different
        const vk::Buffer sourceBuffer = vk::makeBuffer(device, source, "layout source");
        const vk::Buffer resultBuffer(device, {.size = offsets.size() * 4, .name = "layout result"});
        const std::vector<uint32_t> code = compileShader({.name = entry.name + ".comp",
                                                          .text = kernelFor(structs, entry.name),
                                                          .definitions = {},
                                                          .includeFolder = kShaderFolder});
        const vk::ComputeProgram program(device, code, entry.name);
        struct Push {
            VkDeviceAddress source, result;
        };
        vk::Commands commands(device);
        program.dispatch(commands.begin(), Push{sourceBuffer.address(), resultBuffer.address()}, 1);
        commands.run();
        std::vector<uint32_t> expected;
        for (size_t offset : offsets)
            expected.push_back(source[(size + offset) / 4]);
        EXPECT_EQ(vk::readBuffer<uint32_t>(device, resultBuffer, expected.size()), expected) << entry.name;
    }
}

} // namespace relume
