#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace relume {
namespace {

namespace fs = std::filesystem;

struct Outcome {
    int status = -1;
    std::string output, errors;
};

class CompareTest : public testing::Test {
protected:
    std::string image(const std::string& name, uint32_t size, float value) const {
        FloatImage image{size, size, {}, {}, {}};
        for (const char* channel : {"R", "G", "B"})
            image.add(channel).assign(size_t(size) * size, value);
        const std::string path = folder_.path(name);
        writeImage(path, image);
        return path;
    }

    /// Runs `relume compare` with these arguments.
    Outcome compare(const std::string& arguments) const {
        const std::string errors = folder_.path("errors.txt");
        FILE* pipe = popen((RELUME_BINARY " compare " + arguments + " 2>'" + errors + "'").c_str(), "r");
        if (!pipe) return {};
        Outcome outcome;
        for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe))
            outcome.output += char(c);
        const int status = pclose(pipe);
        outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        if (FILE* file = fopen(errors.c_str(), "r")) {
            for (int c = fgetc(file); c != EOF; c = fgetc(file))
                outcome.errors += char(c);
            fclose(file);
        }
        return outcome;
    }

    const TemporaryFolder folder_;
};

TEST_F(CompareTest, PrintsATable) {
    const Outcome outcome = compare(image("a.exr", 4, 0.75f) + " " + image("b.exr", 4, 0.5f));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.errors, "");
    for (const char* line : {"relRMSE           0.5  ", "RMSE             0.25  ", "maximum          0.25  ",
                             "bias             0.25  ", "texels             16  compared"})
        EXPECT_NE(outcome.output.find(line), std::string::npos) << line << "\nin\n" << outcome.output;
}

TEST_F(CompareTest, PrintsJson) {
    const std::string a = image("a.exr", 4, 0.25f), b = image("b.exr", 4, 0.5f);
    const auto told = nlohmann::json::parse(compare("--json " + a + " " + b).output);
    EXPECT_EQ(told.at("a"), a);
    EXPECT_EQ(told.at("b"), b);
    EXPECT_DOUBLE_EQ(told.at("relRMSE"), 0.5);
    EXPECT_DOUBLE_EQ(told.at("RMSE"), 0.25);
    EXPECT_DOUBLE_EQ(told.at("bias"), -0.25);
    EXPECT_DOUBLE_EQ(told.at("maximum"), 0.25);
    EXPECT_GT(told.at("DFPR"), 0.1);
    EXPECT_EQ(told.at("texels"), 16);
    const auto black = nlohmann::json::parse(compare("--json " + a + " " + image("c.exr", 4, 0.0f)).output);
    EXPECT_TRUE(black.at("relRMSE").is_null());
}

// B says by its noise that the left column is dark; another image that the right one is.
TEST_F(CompareTest, TellsTheBiasOfTheDarkestQuarter) {
    const auto columns = [&](const std::string& name, const std::vector<float>& values) {
        FloatImage picture{4, 2, {}, {}, {}};
        for (const char* channel : {"R", "G", "B"}) {
            std::vector<float>& plane = picture.add(channel);
            for (size_t i = 0; i < plane.size(); ++i)
                plane[i] = values[i % 4];
        }
        writeImage(folder_.path(name), picture);
        return folder_.path(name);
    };
    const std::string a = columns("a.exr", {0.3f, 0.5f, 0.5f, 0.5f}),
                      b = columns("b.exr", {0.2f, 0.5f, 0.5f, 0.4f});
    const std::string by = columns("by.exr", {0.9f, 0.5f, 0.5f, 0.1f});
    EXPECT_NEAR(std::stod(compare(a + " " + b + " --metric dark").output), 0.5, 1e-6);
    EXPECT_NEAR(std::stod(compare(a + " " + b + " --metric dark --dark-by " + by).output), 0.25, 1e-6);
    EXPECT_EQ(compare(a + " " + b + " --metric bias --dark-by " + by).status, 2);
    const Outcome other = compare(a + " " + b + " --dark-by " + image("small.exr", 2, 0.5f));
    EXPECT_EQ(other.status, 1);
    EXPECT_NE(other.errors.find("small.exr is 2 x 2, the images are 4 x 2"), std::string::npos)
        << other.errors;
    const auto told = nlohmann::json::parse(compare("--json " + a + " " + b + " --dark-by " + by).output);
    EXPECT_NEAR(told.at("dark").get<double>(), 0.25, 1e-6);
    EXPECT_EQ(told.at("darkBy"), by);
}

TEST_F(CompareTest, ComparesPngWithExr) {
    const std::string png = image("a.png", 4, 0.5f), exr = image("b.exr", 4, 0.5f);
    const auto told = nlohmann::json::parse(compare("--json " + png + " " + exr).output);
    EXPECT_LT(told.at("DFPR"), 0.5 / 255 * 1.8); // half a level in each channel
    EXPECT_GT(told.at("RMSE"), 0.0);
}

TEST_F(CompareTest, RefusesUnlikeSizes) {
    const Outcome outcome = compare(image("a.exr", 4, 1) + " " + image("b.exr", 5, 1));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.output, "");
    EXPECT_NE(outcome.errors.find("a.exr is 4 x 4"), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.errors.find("b.exr is 5 x 5"), std::string::npos) << outcome.errors;
}

TEST_F(CompareTest, FailsOnMissingFilesAndArguments) {
    const std::string a = image("a.exr", 4, 1);
    const Outcome missing = compare(a + " " + folder_.path("none.exr"));
    EXPECT_EQ(missing.status, 1);
    EXPECT_NE(missing.errors.find("none.exr: no such file"), std::string::npos) << missing.errors;
    EXPECT_EQ(compare(a).status, 2);
    EXPECT_EQ(compare("--nonsense " + a + " " + a).status, 2);
    const Outcome help = compare("--help");
    EXPECT_EQ(help.status, 0);
    EXPECT_NE(help.output.find("--json"), std::string::npos);
}

TEST_F(CompareTest, PrintsTheMetricsAskedFor) {
    const std::string files = image("a.exr", 4, 0.75f) + " " + image("b.exr", 4, 0.5f);
    EXPECT_EQ(compare("--metric rmse " + files).output, "0.25\n");
    EXPECT_EQ(compare(files + " --metric relrmse,Maximum --metric bias").output, "0.5\n0.25\n0.25\n");
    const double seen = std::stod(compare("--metric flip " + files).output);
    // Grey on grey gives a lightness difference of 116 (cbrt(0.75) - cbrt(0.5)), by the paper's formulas
    // (flip_test.cpp).
    const double knee = 0.4 * std::pow(203.31, 0.7);
    EXPECT_NEAR(seen, 0.95 / knee * std::pow(116 * (std::cbrt(0.75) - std::cbrt(0.5)), 0.7), 1e-4);
    const std::string black = image("c.exr", 4, 0.0f);
    EXPECT_EQ(compare("--metric relrmse " + image("a.exr", 4, 1) + " " + black).output, "inf\n");
    EXPECT_EQ(compare("--metric nonsense " + files).status, 2);
    EXPECT_EQ(compare("--ppd 0 " + files).status, 2);
    const auto told = nlohmann::json::parse(compare("--json --metric rmse " + files).output);
    EXPECT_TRUE(told.contains("RMSE"));
    EXPECT_FALSE(told.contains("FLIP"));
    EXPECT_GT(nlohmann::json::parse(compare("--json " + files).output).at("FLIP"), 0.1);
}

TEST_F(CompareTest, ComparesUnderAMask) {
    const std::string a = image("a.exr", 4, 0.75f), b = image("b.exr", 4, 0.5f);
    FloatImage half{4, 4, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        half.add(channel) = {1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0};
    const std::string mask = folder_.path("mask.png");
    writeImage(mask, half);
    const Outcome outcome = compare(a + " " + b + " --mask " + mask);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_NE(outcome.output.find("texels              8  compared"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("masked 8"), std::string::npos) << outcome.output;
    EXPECT_EQ(nlohmann::json::parse(compare(a + " " + b + " --json --mask " + mask).output).at("masked"), 8);

    const Outcome unlike = compare(a + " " + b + " --mask " + image("small.exr", 2, 1));
    EXPECT_EQ(unlike.status, 1);
    EXPECT_NE(unlike.errors.find("small.exr is 2 x 2"), std::string::npos) << unlike.errors;
    const Outcome empty = compare(a + " " + b + " --mask " + image("zero.exr", 4, 0));
    EXPECT_EQ(empty.status, 1);
    EXPECT_NE(empty.errors.find("zero.exr: lets no covered texel through"), std::string::npos)
        << empty.errors;
    EXPECT_EQ(compare(a + " " + b + " --mask " + folder_.path("none.png")).status, 1);
}

TEST_F(CompareTest, DrawsTheDifferences) {
    const std::string a = image("a.exr", 4, 0.75f), b = image("b.exr", 4, 0.5f);
    const std::string png = folder_.path("diff.png");
    const Outcome outcome = compare(a + " " + b + " --diff " + png);
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_NE(outcome.errors.find("difference / mean of B from 0 (black) to 0.5 (white)"), std::string::npos)
        << outcome.errors;
    EXPECT_EQ(readImage(png).planes[0][5], 1.0f); // 50 % of the mean everywhere: the end of the scale
    const auto told = nlohmann::json::parse(compare(a + " " + b + " --json --diff " + png).output);
    EXPECT_EQ(told.at("diff").at("scale"), 0.5);
    compare(a + " " + b + " --metric flip --diff " + png);
    const FloatImage seen = readImage(png);
    EXPECT_GT(seen.planes[1][5], 0.1f);
    EXPECT_LT(seen.planes[1][5], 1.0f);
    compare(a + " " + a + " --diff " + png);
    EXPECT_EQ(readImage(png).planes[0][5], 0.0f);
    // Nothing is relative to black.
    EXPECT_EQ(compare(a + " " + image("c.exr", 4, 0) + " --diff " + png).status, 0);
    EXPECT_EQ(readImage(png).planes[0][5] > 0.1f, true);

    EXPECT_EQ(compare(a + " " + b + " --diff " + folder_.path("diff.exr")).status, 2);
    const Outcome unwritable = compare(a + " " + b + " --diff " + folder_.path("no/diff.png"));
    EXPECT_EQ(unwritable.status, 1);
    EXPECT_EQ(unwritable.output, "");
    EXPECT_NE(unwritable.errors.find("diff.png"), std::string::npos) << unwritable.errors;
}

TEST_F(CompareTest, TellsTheLocalError) {
    const std::string a = image("a.exr", 4, 0.75f), b = image("b.exr", 4, 0.5f), c = image("c.exr", 4, 0.0f);
    EXPECT_EQ(compare(a + " " + b + " --metric local").output, "0.5\n");
    EXPECT_EQ(compare(a + " " + c + " --metric local").output, "inf\n");
    EXPECT_EQ(compare(c + " " + c + " --metric local").output, "0\n");
    const std::string table = compare(a + " " + b).output;
    EXPECT_NE(table.find("local             0.5  "), std::string::npos) << table;
    EXPECT_NE(table.find("p50 0.5, p90 0.5, p95 0.5, p99 0.5"), std::string::npos) << table;
    const auto told = nlohmann::json::parse(compare(a + " " + b + " --json --metric local").output);
    for (const char* name : {"p50", "p90", "p95", "p99"})
        EXPECT_EQ(told.at("local").at(name), 0.5) << name;
    EXPECT_FALSE(told.contains("RMSE"));
    const auto black = nlohmann::json::parse(compare(a + " " + c + " --json").output);
    EXPECT_TRUE(black.at("local").at("p95").is_null());
    const std::string png = folder_.path("diff.png");
    const Outcome outcome = compare(a + " " + b + " --metric local --diff " + png);
    EXPECT_NE(outcome.errors.find("local error from 0 (black) to 0.5 (white)"), std::string::npos)
        << outcome.errors;
    EXPECT_EQ(readImage(png).planes[0][5], 1.0f);
    EXPECT_EQ(compare(a + " " + c + " --metric local --diff " + png).status, 0);
    EXPECT_EQ(readImage(png).planes[0][5], 1.0f); // what is infinitely off is at the bright end
}

} // namespace
} // namespace relume
