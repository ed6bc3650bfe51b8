// The program itself bakes with all methods, tracers, layers and presets: the light is, to the bit, what
// tests/golden/bakes.txt says.
#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace relume {
namespace {

const std::string kList = RELUME_SOURCE_DIR "/tests/golden/bakes.txt";

/// Holds one line of the list.
struct GoldenBake {
    std::string name, hash;
    std::vector<std::string> arguments;
};

void PrintTo(const GoldenBake& bake, std::ostream* stream) {
    *stream << bake.name;
}

std::vector<GoldenBake> readList() {
    std::vector<GoldenBake> bakes;
    std::ifstream file(kList);
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#' || line.starts_with("kind:")) continue;
        std::istringstream words(line);
        GoldenBake bake;
        words >> bake.name >> bake.hash;
        bake.name.pop_back(); // the colons
        bake.hash.pop_back();
        for (std::string word; words >> word;)
            bake.arguments.push_back(word);
        bakes.push_back(bake);
    }
    return bakes;
}

/// Names the processor: its vendor and the signature of its family and model; "" on other architectures.
std::string processorName() {
#if defined(__x86_64__)
    unsigned int most = 0, signature = 0, b = 0, c = 0, d = 0;
    std::array<char, 12> vendor{};
    if (__get_cpuid(0, &most, &b, &c, &d) == 0) return "";
    std::memcpy(vendor.data(), &b, 4);
    std::memcpy(vendor.data() + 4, &d, 4);
    std::memcpy(vendor.data() + 8, &c, 4);
    __get_cpuid(1, &signature, &b, &c, &d);
    constexpr unsigned int kStepping = 0xf;
    return fmt::format(", {} {:x}", std::string(vendor.begin(), vendor.end()), signature & ~kStepping);
#else
    return "";
#endif
}

/// Tells which machines make the same bits: those with this device, this widest vector unit and this model of
/// processor. Embree and the software device choose their code by the vector unit, and the estimates of
/// reciprocals that they start from are the model's own.
std::string kindOfMachine() {
    __builtin_cpu_init();
    const std::string vectors = __builtin_cpu_supports("avx512f") ? "avx512"
                                : __builtin_cpu_supports("avx2")  ? "avx2"
                                                                  : "sse";
    return testDevice().info().name + ", " + vectors + processorName();
}

std::string kindOfList() {
    std::ifstream file(kList);
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("kind: ")) return line.substr(6);
    return "";
}

bool updating() {
    return std::getenv("RELUME_UPDATE_GOLDEN") != nullptr;
}

/// Replaces one word of the list, behind `before`, up to `after`.
void updateList(const std::string& before, const std::string& after, const std::string& word) {
    std::string text = bytesOf(kList);
    const size_t begin = text.find(before) + before.size();
    text.replace(begin, text.find(after, begin) - begin, word);
    std::ofstream(kList, std::ios::binary) << text;
}

/// Returns the SHA-256 of all planes in the order of their channels, by the system's program.
std::string hashOf(const FloatImage& image, const TemporaryFolder& folder) {
    const std::string path = folder.path("pixels");
    std::ofstream file(path, std::ios::binary);
    for (size_t c = 0; c < image.channels.size(); ++c) {
        file << image.channels[c] << '\n';
        file.write(reinterpret_cast<const char*>(image.planes[c].data()),
                   static_cast<std::streamsize>(image.planes[c].size() * sizeof(float)));
    }
    file.close();
    const ProcessResult result = runProgram("/usr/bin/sha256sum", {path});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out.substr(0, result.out.find(' '));
}

std::string replaced(std::string text, const std::string& word, const std::string& by) {
    const size_t at = text.find(word);
    if (at != std::string::npos) text.replace(at, word.size(), by);
    return text;
}

/// Interrupts a bake once its first checkpoint is there, and lets another one go on from it.
ProcessResult bakeInTwo(std::vector<std::string> arguments, const std::string& checkpoint) {
    const ProcessResult first = runRelume(
        arguments, [&](const std::string&) { return std::filesystem::exists(checkpoint) ? SIGINT : 0; });
    if (first.status == 0) return first; // it was done before it could be interrupted
    arguments.insert(arguments.end(), {"--resume", checkpoint});
    return runRelume(arguments);
}

class GoldenBakes : public testing::TestWithParam<GoldenBake> {};

TEST_P(GoldenBakes, KeepTheirLight) {
    const GoldenBake& bake = GetParam();
    if (!updating() && kindOfMachine() != kindOfList())
        GTEST_SKIP() << "the hashes are of '" << kindOfList() << "', this is '" << kindOfMachine() << "'";
    const TemporaryFolder folder;
    const std::string output = folder.path("light.exr"), checkpoint = folder.path("checkpoint");
    std::vector<std::string> arguments;
    for (const std::string& word : bake.arguments)
        arguments.push_back(
            replaced(replaced(replaced(word, "SCENES", RELUME_SOURCE_DIR "/assets/scenes"), "OUTPUT", output),
                     "CHECKPOINT", checkpoint));
    std::replace(arguments.back().begin(), arguments.back().end(), '_', ' '); // an object's name
    if (bake.arguments.front() == "bake") arguments.insert(arguments.end(), {"-o", output});
    arguments.insert(arguments.end(), {"--device", testDevice().info().name});
    const bool resumed = std::find(arguments.begin(), arguments.end(), checkpoint) != arguments.end();
    const ProcessResult result = resumed ? bakeInTwo(arguments, checkpoint) : runRelume(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
    const std::string hash = hashOf(readImage(output), folder);
    if (updating()) {
        updateList("\nkind: ", "\n", kindOfMachine());
        updateList("\n" + bake.name + ": ", ":", hash);
    } else {
        EXPECT_EQ(hash, bake.hash)
            << "other light than before: if it is meant, RELUME_UPDATE_GOLDEN=1 takes it";
    }
}

INSTANTIATE_TEST_SUITE_P(All, GoldenBakes, testing::ValuesIn(readList()),
                         [](const auto& bake) { return bake.param.name; });

} // namespace
} // namespace relume
