#include "assets/images/float_image.h"

#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/images/image_file.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <thread>
#include <vector>

namespace relume {
namespace {

namespace fs = std::filesystem;

class FloatImageTest : public testing::Test {
protected:
    std::string at(const std::string& name) const { return folder_.path(name); }
    size_t fileCount() const { return folder_.files().size(); }

    const TemporaryFolder folder_;
};

void store(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// Returns what `action` says when it throws Error.
template<class Action>
std::string errorOf(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

FloatImage ramp(uint32_t width, uint32_t height) {
    FloatImage image{width, height, {}, {}, {}};
    for (const char* channel : {"R", "G", "B", "coverage"}) {
        std::vector<float>& plane = image.add(channel);
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = float(i + 1) * (1.0f + float(image.channels.size())) / float(plane.size());
    }
    return image;
}

TEST_F(FloatImageTest, KeepsFloatsBitByBit) {
    FloatImage image = ramp(7, 5);
    image.planes[0][3] = std::numeric_limits<float>::quiet_NaN();
    image.planes[1][4] = std::numeric_limits<float>::infinity();
    image.planes[2][5] = -1e-40f;
    image.attributes = {{"scene", "room.glb"},
                        {"settings", "--size 5\n--passes 2"},
                        {"a rather long attribute's name, > 31", "x"}};
    writeImage(at("a.exr"), image);
    const FloatImage read = readImage(at("a.exr"));
    EXPECT_EQ(read.width, 7u);
    EXPECT_EQ(read.height, 5u);
    EXPECT_EQ(read.channels, image.channels);
    EXPECT_EQ(read.attributes, image.attributes);
    for (size_t c = 0; c < 4; ++c)
        EXPECT_EQ(std::memcmp(read.planes[c].data(), image.planes[c].data(), 35 * sizeof(float)), 0);
}

constexpr std::array<ExrCompression, 5> kCompressions = {
    ExrCompression::Off, ExrCompression::Rle, ExrCompression::Zips, ExrCompression::Zip, ExrCompression::Piz};

TEST_F(FloatImageTest, EveryCompressionKeepsEveryBit) {
    FloatImage image = ramp(70, 67); // no whole number of rows that are packed together
    std::mt19937 random(7);
    for (std::vector<float>& plane : image.planes)
        for (size_t i = 0; i < plane.size(); i += 3)
            plane[i] = float(random()) * 1e-7f;
    image.planes[0][3] = std::numeric_limits<float>::quiet_NaN();
    image.planes[1][4] = -std::numeric_limits<float>::infinity();
    image.planes[2][5] = -1e-40f;
    const std::string key("compression\0compression\0\1\0\0\0", 28);
    for (size_t i = 0; i < kCompressions.size(); ++i) {
        writeImage(at("a.exr"), image, ExrType::Float, kCompressions[i]);
        const FloatImage read = readImage(at("a.exr"));
        ASSERT_EQ(read.channels, image.channels);
        for (size_t c = 0; c < 4; ++c)
            EXPECT_EQ(std::memcmp(read.planes[c].data(), image.planes[c].data(), 70 * 67 * sizeof(float)), 0)
                << i;
        const std::string bytes = bytesOf(at("a.exr"));
        const size_t place = bytes.find(key);
        ASSERT_NE(place, std::string::npos);
        EXPECT_EQ(size_t(bytes[place + key.size()]), i); // OpenEXR numbers them likewise
    }
}

TEST_F(FloatImageTest, CompressedFilesOfSmoothImagesAreSmaller) {
    const FloatImage image = ramp(64, 64);
    writeImage(at("none.exr"), image, ExrType::Half, ExrCompression::Off);
    for (const ExrCompression compression :
         {ExrCompression::Zips, ExrCompression::Zip, ExrCompression::Piz}) {
        writeImage(at("a.exr"), image, ExrType::Half, compression);
        EXPECT_LT(fs::file_size(at("a.exr")), fs::file_size(at("none.exr")) * 9 / 10);
    }
    writeImage(at("default.exr"), image, ExrType::Half);
    writeImage(at("zip.exr"), image, ExrType::Half, ExrCompression::Zip);
    EXPECT_EQ(bytesOf(at("default.exr")), bytesOf(at("zip.exr")));
}

TEST_F(FloatImageTest, RoundsToHalfAndCutsWhatDoesNotFit) {
    FloatImage image = ramp(40, 33);
    image.planes[0][0] = 1e6f;
    image.planes[0][1] = -1e6f;
    writeImage(at("a.exr"), image, ExrType::Half);
    const FloatImage read = readImage(at("a.exr"));
    EXPECT_EQ(read.channels, image.channels);
    EXPECT_EQ(read.planes[0][0], 65504.0f);
    EXPECT_EQ(read.planes[0][1], -65504.0f);
    for (size_t i = 2; i < image.planes[0].size(); ++i) {
        EXPECT_NEAR(read.planes[0][i], image.planes[0][i], image.planes[0][i] / 2048 + 1e-7f);
        EXPECT_NEAR(read.planes[3][i], image.planes[3][i], image.planes[3][i] / 2048 + 1e-7f);
    }
    writeImage(at("b.exr"), image);
    EXPECT_LT(fs::file_size(at("a.exr")), fs::file_size(at("b.exr")));
}

// Bytes are looked up; they must be those of the formula, above all where one turns into the next.
TEST(SrgbByte, IsWhatTheTransferFunctionGives) {
    const auto formula = [](float v) {
        return uint8_t(std::floor(255.0 * srgbFromLinear(v > 0.0f ? std::min(1.0, double(v)) : 0.0) + 0.5));
    };
    for (const float v :
         {0.0f, -0.0f, -1.0f, 1e-45f, 0.0031308f, 1.0f, 1e30f, std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
        EXPECT_EQ(srgbByte(v), formula(v)) << v;
    for (int k = 1; k <= 255; ++k) {
        float v = float(linearFromSrgb((k - 0.5) / 255.0));
        for (int i = 0; i < 200; ++i)
            v = std::nextafter(v, 0.0f);
        for (int i = 0; i < 400; ++i, v = std::nextafter(v, 2.0f))
            ASSERT_EQ(srgbByte(v), formula(v)) << v;
    }
    std::mt19937 random(11);
    std::uniform_real_distribution<float> values(-0.1f, 1.1f);
    for (int i = 0; i < 100000; ++i) {
        const float v = values(random);
        ASSERT_EQ(srgbByte(v), formula(v)) << v;
    }
}

TEST_F(FloatImageTest, GivesEqualBytesForEqualImages) {
    const FloatImage image = ramp(64, 64);
    for (const char* ending : {"exr", "png"}) {
        writeImage(at(std::string("a.") + ending), image);
        writeImage(at(std::string("other name.") + ending), image);
        EXPECT_EQ(bytesOf(at(std::string("a.") + ending)), bytesOf(at(std::string("other name.") + ending)));
    }
}

TEST_F(FloatImageTest, ReadsAnyDataWindowAndUnsignedChannels) {
    const FloatImage image = ramp(5, 4); // one block of lines, at the only offset of the table
    writeImage(at("a.exr"), image);
    std::string bytes = bytesOf(at("a.exr"));
    const std::string key("dataWindow\0box2i\0", 17);
    const size_t window = bytes.find(key) + key.size() + 4;
    const int32_t shifted[4] = {-3, 17, 1, 20};
    std::memcpy(&bytes[window], shifted, sizeof shifted);
    size_t block = 8;
    for (uint64_t offset = 0; block < bytes.size(); ++block)
        if (std::memcpy(&offset, &bytes[block - 8], 8); offset == block) break;
    ASSERT_LT(block, bytes.size());
    std::memcpy(&bytes[block], &shifted[1], 4); // the block's first line
    const std::string green("\0G\0\2", 4);      // name, then pixel type 2 = float
    const size_t type = bytes.find(green);
    ASSERT_NE(type, std::string::npos);
    bytes[type + 3] = 0; // unsigned
    store(at("b.exr"), bytes);

    const FloatImage read = readImage(at("b.exr"));
    ASSERT_EQ(read.width, 5u);
    ASSERT_EQ(read.height, 4u);
    EXPECT_EQ(read.planes[0], image.planes[0]);
    EXPECT_EQ(read.planes[2], image.planes[2]);
    uint32_t bits = 0;
    std::memcpy(&bits, &image.planes[1][7], 4);
    EXPECT_EQ(read.planes[1][7], float(bits));
}

TEST(Srgb, IsExact) {
    EXPECT_DOUBLE_EQ(srgbFromLinear(0), 0);
    EXPECT_DOUBLE_EQ(srgbFromLinear(1), 1);
    EXPECT_NEAR(srgbFromLinear(0.0031308), 0.04045, 1e-6);
    EXPECT_DOUBLE_EQ(srgbFromLinear(0.001), 0.01292);
    EXPECT_NEAR(srgbFromLinear(0.2140411), 0.5, 1e-6);
    for (int i = -50; i <= 150; ++i)
        EXPECT_NEAR(linearFromSrgb(srgbFromLinear(i / 100.0)), i / 100.0, 1e-6);
}

TEST_F(FloatImageTest, WritesPngAsSrgb) {
    FloatImage image{4, 2, {}, {}, {}};
    image.add("R") = {0.0f, 0.5f, 1.0f, 2.0f, -1.0f, std::nanf(""), 0.001f, 0.2158605f};
    image.add("G") = std::vector<float>(8, 1.0f);
    image.add("B") = std::vector<float>(8, 0.0f);
    writeImage(at("a.PNG"), image);
    const FloatImage read = readImage(at("a.PNG"));
    const int levels[8] = {0, 188, 255, 255, 0, 0, 3, 128}; // row 0 first
    ASSERT_EQ(read.width, 4u);
    ASSERT_EQ(read.height, 2u);
    ASSERT_EQ(read.channels, (std::vector<std::string>{"R", "G", "B"}));
    for (size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(std::lround(255 * srgbFromLinear(read.planes[0][i])), levels[i]) << i;
        EXPECT_EQ(read.planes[1][i], 1.0f);
        EXPECT_EQ(read.planes[2][i], 0.0f);
    }
    FloatImage grey{1, 1, {"Y"}, {{1.0f}}, {}};
    EXPECT_NE(errorOf([&] { writeImage(at("b.png"), grey); }).find("no channel R"), std::string::npos);
    EXPECT_FALSE(fs::exists(at("b.png")));
}

TEST_F(FloatImageTest, NamesWhatCannotBeRead) {
    EXPECT_NE(errorOf([&] { readImage(at("none.exr")); }).find("none.exr: no such file"), std::string::npos);
    EXPECT_NE(errorOf([&] { readImage(at("a.tiff")); }).find("use .exr or .png"), std::string::npos);
    fs::create_directory(at("folder.exr"));
    EXPECT_NE(errorOf([&] { readImage(at("folder.exr")); }).find("is a folder"), std::string::npos);
    for (const char* name : {"empty.exr", "empty.png"}) {
        store(at(name), "");
        EXPECT_NE(errorOf([&] { readImage(at(name)); }).find("cannot be read as an image"),
                  std::string::npos);
    }
}

TEST_F(FloatImageTest, SurvivesBrokenFiles) {
    std::mt19937 random(1);
    for (const std::string name : {"a.exr", "a.png"}) {
        writeImage(at(name), ramp(20, 20));
        const std::string whole = bytesOf(at(name));
        size_t refused = 0;
        for (size_t length = 0; length < whole.size(); length += 13) {
            store(at(name), whole.substr(0, length));
            const std::string message = errorOf([&] { readImage(at(name)); });
            refused += !message.empty();
            EXPECT_EQ(message.find('\n'), std::string::npos);
        }
        EXPECT_TRUE(name == "a.png" || refused == (whole.size() + 12) / 13);
        for (int k = 0; k < 500; ++k) {
            std::string broken = whole;
            for (int n = 0; n < 3; ++n)
                broken[random() % (k % 2 ? broken.size() : std::min<size_t>(broken.size(), 400))] =
                    char(random());
            store(at(name), broken);
            errorOf([&] { readImage(at(name)); }); // either outcome is fine, a crash is not
        }
    }
}

TEST_F(FloatImageTest, LeavesTheOldFileWhenTheDiskIsFull) {
    const FloatImage small = ramp(2, 2);
    writeImage(at("a.exr"), small);
    const std::string before = bytesOf(at("a.exr"));
    FloatImage large{256, 256, {}, {}, {}};
    std::mt19937 random(1);
    for (const char* channel : {"R", "G", "B"})
        for (float& v : large.add(channel))
            v = float(random());
    const std::string path = at("a.exr");
    // A limit on the size of files acts as a full disk does: the write stops short, then fails.
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit = {10000, 10000};
        setrlimit(RLIMIT_FSIZE, &limit);
        const std::string message = errorOf([&] { writeImage(path, large); });
        const bool right = message.find(path + ": cannot write: ") == 0 &&
                           message.find("free some space") != std::string::npos;
        _exit(message.empty() ? 1 : right ? 0 : 2);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    EXPECT_EQ(bytesOf(path), before);
    EXPECT_EQ(fileCount(), 1u); // no temporary file stays
}

// They compress on all cores, in portions whose size depends on how many there are.
TEST_F(FloatImageTest, FilesWrittenAtOnceAreThoseWrittenAlone) {
    const std::array<FloatImage, 2> images = {ramp(300, 301), ramp(70, 500)};
    std::array<std::string, 2> alone;
    for (size_t i = 0; i < 2; ++i) {
        writeImage(at("alone.exr"), images[i]);
        alone[i] = bytesOf(at("alone.exr"));
    }
    std::vector<std::thread> writers;
    for (size_t i = 0; i < 2; ++i)
        writers.emplace_back([&, i] {
            for (int time = 0; time < 20; ++time)
                writeImage(at(std::to_string(i) + ".exr"), images[i]);
        });
    for (std::thread& writer : writers)
        writer.join();
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(bytesOf(at(std::to_string(i) + ".exr")), alone[i]);
        EXPECT_EQ(readImage(at(std::to_string(i) + ".exr")).planes, images[i].planes);
    }
}

TEST_F(FloatImageTest, ReplacesFilesAndFollowsLinks) {
    writeImage(at("real.exr"), ramp(2, 2));
    fs::create_symlink("real.exr", at("link.exr"));
    writeImage(at("link.exr"), ramp(3, 3));
    EXPECT_TRUE(fs::is_symlink(at("link.exr")));
    EXPECT_EQ(readImage(at("real.exr")).width, 3u);
    EXPECT_EQ(fileCount(), 2u);
    const mode_t mask = umask(0);
    umask(mask);
    struct stat info {};
    ASSERT_EQ(stat(at("real.exr").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777u, 0666u & ~mask);
}

TEST_F(FloatImageTest, FindsOutBeforehandWhatCannotBeWritten) {
    checkWritable(at("a.exr"), 1000);
    EXPECT_EQ(fileCount(), 0u);
    const auto complaint = [](const std::string& path, uint64_t bytes = 0) {
        return errorOf([&] { checkWritable(path, bytes); });
    };
    EXPECT_NE(complaint(at("none/a.exr")).find("does not exist"), std::string::npos);
    EXPECT_NE(complaint(at("a")).find("unknown image ending"), std::string::npos);
    EXPECT_NE(complaint(at("a.jpg")).find("use .exr or .png"), std::string::npos);
    EXPECT_NE(complaint(at("a.exr"), uint64_t(1) << 60).find("free some space"), std::string::npos);
    fs::create_directory(at("folder.exr"));
    EXPECT_NE(complaint(at("folder.exr")).find("is a folder"), std::string::npos);
    store(at("file"), "x");
    EXPECT_NE(complaint(at("file/a.exr")).find("is not a folder"), std::string::npos);
    EXPECT_NE(complaint("/proc/a.exr").find("/proc/a.exr: cannot write: "),
              std::string::npos); // root may not either
    if (geteuid() != 0) {
        fs::create_directory(at("locked"));
        fs::permissions(at("locked"), fs::perms::owner_read | fs::perms::owner_exec);
        EXPECT_NE(complaint(at("locked/a.exr")).find("Permission denied"), std::string::npos);
    }
}

} // namespace
} // namespace relume
