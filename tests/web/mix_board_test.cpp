// These tests open exported pages with a mix board in headless Chromium, from the disk, and hold what they
// show against `relume mix` and `relume shot`.
#include "assets/base/file_write.h"
#include "assets/images/image_file.h"
#include "assets/images/png_write.h"
#include "assets/images/shared_exponent.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/unit/glb_builder.h"
#include "tests/web/web_page.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

namespace relume {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint32_t kPageWidth = 800, kPageHeight = 450; // of the compared pictures [pixels]
constexpr size_t kLamps = 14;                           // of the gallery
const std::string kGallery = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/gallery.glb";

void run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "-q");
    const ProcessResult result = runRelume(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
}

double number(const json& point, const char* from, const char* to) {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c)
        sum += std::pow(point[from][c].get<double>() - point[to][c].get<double>(), 2);
    return std::sqrt(sum);
}

struct Weighting {
    double intensity;
    double color[3];
};

std::vector<Weighting> randomWeighting(std::mt19937& random) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<Weighting> lamps(kLamps);
    for (Weighting& lamp : lamps) {
        const bool on = share(random) < 0.75;
        lamp.intensity = on ? 4.0 * std::pow(10.0, 2.0 * share(random)) : 0.0; // [cd/m^2], up to 400
        for (double& c : lamp.color)
            c = share(random);
    }
    return lamps;
}

json jsonOf(const std::vector<Weighting>& lamps) {
    json mix = json::array();
    for (const Weighting& lamp : lamps)
        mix.push_back({{"intensity", lamp.intensity},
                       {"color", {lamp.color[0], lamp.color[1], lamp.color[2]}},
                       {"muted", false}});
    return mix;
}

class MixBoard : public testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!whyNoPages().empty()) return;
        folder_ = std::make_unique<TemporaryFolder>();
        fs::copy_file(kGallery, folder_->path("gallery.glb"));
        run({"bake", folder_->path("gallery.glb"), "--layers", "-o", layers(), "--size", "128", "--samples",
             "64"});
        run({"export", layers(), "--web", folder_->path("page")});
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override {
        if (const std::string reason = whyNoPages(); !reason.empty()) GTEST_SKIP() << reason;
    }

    static std::string layers() { return folder_->path("layers.exr"); }
    static std::string page() { return folder_->path("page/index.html"); }

    // Opens a page, lets it do a job and returns what came of it; pictures go to the folder of this test.
    json opened(const std::string& path, json job) {
        writeFileAtomically(out_.path("job.json"), job.dump());
        const std::string script = std::string(RELUME_SOURCE_DIR) + "/tests/web/mix_board.mjs";
        constexpr double kLimit = 600; // [s]
        const ProcessResult result = runProgram(
            "/usr/bin/env", {"node", script, path, out_.path("job.json"), out_.path()}, nullptr, kLimit);
        EXPECT_EQ(result.status, 0) << result.err;
        const json told = json::parse(bytesOf(out_.path("result.json")));
        EXPECT_EQ(told["errors"], json::array());
        EXPECT_EQ(told["failed"], "");
        EXPECT_EQ(told["requests"], json::array()) << "the page asks a network";
        EXPECT_EQ(told["sideways"], false) << "the page scrolls sideways";
        return told;
    }

    // Returns how far the page's picture is off that of a shot, of each channel as displayed; full scale
    // is 1.
    std::vector<double> differences(size_t number, const std::string& scene, const std::string& lightmap,
                                    double exposure = 0.0) {
        run({"shot", scene, "--lightmap", lightmap, "--exposure", fmt::format("{}", exposure), "--size",
             fmt::format("{}x{}", kPageWidth, kPageHeight), "-o", out_.path("shot.png")});
        const FloatImage right = readImage(out_.path("shot.png"));
        const auto pixels = bytesOf(out_.path(fmt::format("mix{}.rgb", number)));
        std::vector<double> off;
        EXPECT_EQ(pixels.size(), size_t{3} * kPageWidth * kPageHeight);
        if (pixels.size() != size_t{3} * kPageWidth * kPageHeight) return {1.0};
        for (size_t i = 0; i < pixels.size(); ++i)
            off.push_back(std::abs(static_cast<uint8_t>(pixels[i]) / 255.0 -
                                   srgbFromLinear(double(right.planes[i % 3][i / 3]))));
        std::sort(off.begin(), off.end());
        return off;
    }

    // Makes the lightmap of a mix.
    std::string mixed(const std::vector<Weighting>& lamps) {
        std::vector<std::string> mix = {"mix", layers(), "-o", out_.path("mix.exr")};
        for (size_t i = 0; i < lamps.size(); ++i) {
            const Weighting& lamp = lamps[i];
            mix.insert(mix.end(), {"--set", fmt::format("Lamp {}={},{},{},{}", i + 1, lamp.intensity,
                                                        lamp.color[0], lamp.color[1], lamp.color[2])});
        }
        run(mix);
        return out_.path("mix.exr");
    }

    static std::unique_ptr<TemporaryFolder> folder_;
    TemporaryFolder out_;
};

std::unique_ptr<TemporaryFolder> MixBoard::folder_;

TEST_F(MixBoard, HundredRandomWeightingsLookAsMixAndShotHaveThem) {
    constexpr size_t kMixes = 100;
    std::mt19937 random(14);
    std::vector<std::vector<Weighting>> mixes;
    json job = {{"viewport", {1280, 800}}, {"width", kPageWidth}, {"height", kPageHeight}, {"exposure", 0}};
    for (size_t i = 0; i < kMixes; ++i) {
        mixes.push_back(randomWeighting(random));
        job["mixes"].push_back(jsonOf(mixes.back()));
    }
    opened(
        page(),
        job); // without glow: a mix changes the lightmap alone, and a shot shows lamps as the scene has them
    double worst = 0, sum = 0, count = 0;
    for (size_t i = 0; i < kMixes; ++i) {
        const std::vector<double> off = differences(i, kGallery, mixed(mixes[i]));
        worst = std::max(worst, off[size_t(0.99 * double(off.size()))]);
        for (const double v : off)
            sum += v;
        count += double(off.size());
    }
    std::printf("worst p99 of %zu mixes: %.3f %%, mean %.4f %%\n", kMixes, 100 * worst, 100 * sum / count);
    EXPECT_LE(worst, 0.01);
}

// The scenes have panes, pictures, a sky and a sun between them, and what no lightmap lights.
TEST_F(MixBoard, OtherScenesLookAsAShotHasThem) {
    struct Other {
        const char* name;
        double exposure; // [EV]
        double p99;      // of the differences
    };
    // The streets of "raw" are pictures seen at flat angles: Chromium's software device and Mesa's choose
    // other levels and samples of the same texture, and its edges are many.
    for (const auto& [name, exposure, bound] :
         {Other{"atrium", 0.0, 0.01}, Other{"raw", -11.8, 0.06}, Other{"cornell_layers", 0.0, 0.01},
          Other{"cornell_statue", 0.0, 0.01}}) {
        const std::string scene = fmt::format("{}/assets/scenes/{}.glb", RELUME_SOURCE_DIR, name);
        const std::string exr = out_.path(fmt::format("{}.exr", name)), page = out_.path(name);
        run({"bake", scene, "--layers", "-o", exr, "--size", "256", "--samples", "16"});
        run({"export", scene, "--layers", exr, "--web", page});
        opened(page + "/index.html", {{"viewport", {1280, 800}},
                                      {"width", kPageWidth},
                                      {"height", kPageHeight},
                                      {"exposure", exposure},
                                      {"glow", true},
                                      {"mixes", {json::array()}}});
        const std::vector<double> off = differences(0, scene, exr, exposure);
        const double p99 = off[size_t(0.99 * double(off.size()))];
        const double mean = std::accumulate(off.begin(), off.end(), 0.0) / double(off.size());
        std::printf("%s: p99 %.3f %%, mean %.3f %%\n", name, 100 * p99, 100 * mean);
        EXPECT_LE(p99, bound) << name;
        EXPECT_LE(mean, 0.005) << name;
    }
}

// Makes a floor with a picture of four bands below a sky of four, each as wide as the widest that a page may
// have, and writes the level. Chromium's software device takes half as much.
std::string wideLevel(const TemporaryFolder& folder) {
    constexpr uint32_t kWide = 16383, kSkyWidth = 16384, kSkyHeight = 4;
    std::string pixels;
    for (uint32_t i = 0; i < 2 * kWide; ++i) {
        const uint32_t band = 4 * (i % kWide) / kWide;
        pixels += {char(band == 0 ? 220 : 40), char(band == 1 ? 220 : 60), char(band == 2 ? 220 : 20)};
    }
    const std::string png = writePng(pixels, kWide, 2, 3, "wide");
    FloatImage sky{kSkyWidth, kSkyHeight, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"}) {
        std::vector<float>& plane = sky.add(channel);
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = 4 * (i % kSkyWidth) / kSkyWidth % 3 == size_t(channel[0] == 'G') ? 0.8f : 0.2f;
    }
    writeImage(folder.path("wide.exr"), sky);
    test::GlbBuilder b;
    json floor = b.square();
    floor["attributes"]["TEXCOORD_0"] = b.squareUvs();
    floor["material"] = 0;
    b.json["images"] = {
        {{"bufferView", b.view(std::vector<uint8_t>(png.begin(), png.end()))}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}}};
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
    b.node({{"mesh", b.mesh(floor)}});
    b.node({{"camera", 0}, {"translation", {0.5, 0.5, 1.4}}});
    b.json["scenes"] = {{{"nodes", {0, 1}}, {"extras", {{"relume", {{"sky", {{"file", "wide.exr"}}}}}}}}};
    const std::vector<uint8_t> bytes = b.bytes();
    writeFileAtomically(folder.path("wide.glb"), std::string(bytes.begin(), bytes.end()));
    return folder.path("wide.glb");
}

TEST_F(MixBoard, PicturesThatAreTooLargeForTheDeviceAreMadeSmaller) {
    const std::string scene = wideLevel(out_), exr = out_.path("layers.exr"), page = out_.path("wide");
    run({"bake", scene, "--layers", "-o", exr, "--size", "64", "--samples", "16"});
    run({"export", scene, "--layers", exr, "--web", page});
    // These become means of two pixels each, two means of a column of three, and what they were.
    const auto word = [](float red, float green, float blue) {
        return packSharedExponent({red, green, blue});
    };
    const json skies = {{{word(1, 2, 0), word(2, 4, 0), word(8, 0, 0), word(8, 0, 0.5)}, 4, 1, 2},
                        {{word(1, 1, 1), word(0, 0, 0), word(0.5, 1, 0)}, 1, 3, 2},
                        {{word(1, 1, 1), word(0, 0, 0), word(0.5, 1, 0)}, 1, 3, 3}};
    const json told = opened(page + "/index.html", {{"viewport", {1280, 800}},
                                                    {"width", kPageWidth},
                                                    {"height", kPageHeight},
                                                    {"exposure", 0.0},
                                                    {"glow", true},
                                                    {"skies", skies},
                                                    {"mixes", {json::array()}}});
    const json& small = told["skies"];
    EXPECT_EQ(small[0], json({{word(1.5, 3, 0), word(8, 0, 0.25)}, 2, 1}));
    EXPECT_EQ(small[1][1], 1);
    EXPECT_EQ(small[1][2], 2);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(unpackSharedExponent(small[1][0][0])[c], 2.0f / 3.0f, 0.002f);
        EXPECT_NEAR(unpackSharedExponent(small[1][0][1])[c],
                    c == 0   ? 1.0f / 3.0f
                    : c == 1 ? 2.0f / 3.0f
                             : 0.0f,
                    0.002f);
    }
    EXPECT_EQ(small[2][0], skies[2][0]) << "what is small enough stays";
    const std::vector<double> off = differences(0, scene, exr, 0.0);
    const double mean = std::accumulate(off.begin(), off.end(), 0.0) / double(off.size());
    std::printf("wide pictures: p99 %.3f %%, mean %.3f %%\n", 100 * off[size_t(0.99 * double(off.size()))],
                100 * mean);
    EXPECT_LE(off[size_t(0.99 * double(off.size()))], 0.02);
    EXPECT_LE(mean, 0.005);
}

TEST_F(MixBoard, SlidersShowTheirLightWithinATenthOfASecond) {
    const json told = opened(page(), {{"viewport", {1280, 800}}, {"slides", 64}});
    std::vector<double> times = told["slides"].get<std::vector<double>>();
    std::sort(times.begin(), times.end());
    std::printf("slider to frame: median %.1f ms, p90 %.1f ms\n", times[times.size() / 2],
                times[times.size() * 9 / 10]);
    EXPECT_LE(times[times.size() / 2], 100.0);
    EXPECT_LE(told["drift"], 1) << "steps of 255";
}

TEST_F(MixBoard, KeysReachEveryControl) {
    const json told = opened(page(), {{"viewport", {1280, 800}}, {"keys", true}});
    EXPECT_EQ(told["unlabelled"], 0);
    const json &before = told["before"], &after = told["afterKeys"];
    EXPECT_GT(after["lights"][0]["intensity"], before["lights"][0]["intensity"]);
    EXPECT_EQ(before["lights"][1]["solo"], false);
    EXPECT_EQ(after["lights"][1]["solo"], true);
    EXPECT_EQ(after["camera"]["target"], before["camera"]["target"]);
    EXPECT_NE(after["camera"]["eye"], before["camera"]["eye"]);
    EXPECT_LT(number(told["afterPlus"]["camera"], "eye", "target"),
              0.95 * number(after["camera"], "eye", "target"));
    // What moved is no camera of the list: a browser tells of a choice only where it is another one.
    EXPECT_EQ(told["cameraMoved"], -1);
    EXPECT_EQ(told["cameraChosen"], 0);
    EXPECT_EQ(told["afterChoice"]["camera"], before["camera"]);
}

TEST_F(MixBoard, ALightThatTheFileHasAtZeroIsTurnedUp) {
    const std::string dark = out_.path("dark.exr");
    run({"mix", layers(), "--set", "Lamp 1=0", "--layers-out", "-o", dark});
    run({"export", kGallery, "--layers", dark, "--web", out_.path("dark")});
    const json told = opened(out_.path("dark/index.html"), {{"viewport", {1280, 800}}, {"keys", true}});
    EXPECT_EQ(told["before"]["lights"][0]["intensity"], 0);
    EXPECT_GT(told["afterKeys"]["lights"][0]["intensity"], 0);
}

TEST_F(MixBoard, FingersTurnAndPinchOnAPhone) {
    const json told = opened(page(), {{"viewport", {390, 844}}, {"touch", true}});
    const json &before = told["before"]["camera"], &one = told["afterOne"]["camera"],
               &two = told["afterTwo"]["camera"];
    EXPECT_EQ(one["target"], before["target"]);
    EXPECT_NEAR(number(one, "eye", "target"), number(before, "eye", "target"), 1e-3);
    EXPECT_NE(one["eye"], before["eye"]);
    // The fingers end 110 pixels apart instead of 50.
    EXPECT_NEAR(number(two, "eye", "target"), number(one, "eye", "target") * 50 / 110,
                0.02 * number(one, "eye", "target"));
    EXPECT_NE(two["target"], one["target"]);
    EXPECT_EQ(told["afterTap"]["lights"][1]["muted"], true);
}

TEST_F(MixBoard, OneFileHoldsTheWholePage) {
    fs::create_directory(out_.path("lapse"));
    FloatImage frame{16, 16, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        frame.add(channel).assign(size_t{16} * 16, 0.5f);
    for (const char* name : {"lapse/frame_0001.png", "lapse/frame_0002.png"})
        writeImage(out_.path(name), frame);
    run({"export", kGallery, "--layers", layers(), "--web", out_.path("page.html"), "--single-file",
         "--exposure", "1.5", "--timelapse", out_.path("lapse")});
    fs::create_directory(out_.path("apart"));
    fs::rename(out_.path("page.html"), out_.path("apart/page.html"));
    const json told = opened(out_.path("apart/page.html"), {{"viewport", {800, 600}}, {"keys", true}});
    EXPECT_EQ(told["before"]["lights"].size(), kLamps);
    EXPECT_EQ(told["hides"], json({"#mixB", "#compare", "#reset", "#glow", "#measure"}))
        << "which controls end a picture of the bake on its way";
    EXPECT_EQ(told["oldCommand"], false) << "the command of another mix stays";
}

TEST_F(MixBoard, ExposureIsMeasuredAsAShotDoes) {
    const json told = opened(page(), {{"viewport", {340 + kPageWidth, kPageHeight}}});
    const ProcessResult shot =
        runRelume({"shot", kGallery, "--lightmap", layers(), "--size",
                   fmt::format("{}x{}", kPageWidth, kPageHeight), "-o", out_.path("shot.png")});
    const size_t at = shot.err.find("exposure ");
    ASSERT_NE(at, std::string::npos) << shot.err;
    EXPECT_NEAR(told["measured"].get<double>(), std::stod(shot.err.substr(at + 9)), 0.05);
}

// Makes a row of narrow posts below an even sky, most of whose pixels are edges, and writes the level. The
// camera looks at them, or away from them.
std::string postsLevel(const TemporaryFolder& folder, bool away) {
    constexpr int kPosts = 40;
    test::GlbBuilder b;
    json post = b.square();
    post["attributes"]["TEXCOORD_0"] = b.squareUvs();
    const int mesh = b.mesh(post);
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}};
    json camera = {{"camera", 0}, {"translation", {0.5, 0.5, 1.4}}};
    if (away) camera["rotation"] = {0, 1, 0, 0};
    json nodes = json::array({b.node(camera)});
    for (int i = 0; i < kPosts; ++i)
        nodes.push_back(b.node(
            {{"mesh", mesh}, {"translation", {-0.6 + 2.2 * i / kPosts, 0, 0}}, {"scale", {0.005, 1, 1}}}));
    b.json["scenes"] = {
        {{"nodes", nodes}, {"extras", {{"relume", {{"sky", {{"color", {1, 1, 1}}, {"intensity", 5}}}}}}}}};
    const std::vector<uint8_t> bytes = b.bytes();
    writeFileAtomically(folder.path("posts.glb"), std::string(bytes.begin(), bytes.end()));
    return folder.path("posts.glb");
}

TEST_F(MixBoard, ExposureIsMeasuredAsAShotDoesAtEdgesBeforeTheSkyAndWhereNothingElseIsSeen) {
    for (const bool away : {false, true}) {
        const std::string scene = postsLevel(out_, away), exr = out_.path("layers.exr"),
                          page = out_.path(away ? "away" : "posts");
        run({"bake", scene, "--layers", "-o", exr, "--size", "64", "--samples", "16"});
        run({"export", scene, "--layers", exr, "--web", page});
        const json told = opened(page + "/index.html", {{"viewport", {340 + kPageWidth, kPageHeight}}});
        const ProcessResult shot =
            runRelume({"shot", scene, "--lightmap", exr, "--size",
                       fmt::format("{}x{}", kPageWidth, kPageHeight), "-o", out_.path("shot.png")});
        const size_t at = shot.err.find("exposure ");
        ASSERT_NE(at, std::string::npos) << shot.err;
        EXPECT_NEAR(told["measured"].get<double>(), std::stod(shot.err.substr(at + 9)), 0.1) << away;
    }
}

TEST_F(MixBoard, GalleryAtFullSizeFitsIn25Megabytes) {
    const std::string large = out_.path("large.exr");
    run({"bake", kGallery, "--layers", "-o", large, "--size", "512", "--samples", "16", "--half"});
    run({"export", kGallery, "--layers", large, "--web", out_.path("large.html"), "--single-file"});
    const double bytes = double(fs::file_size(out_.path("large.html")));
    std::printf("gallery at 512 x 512: %.1f MB\n", bytes / 1e6);
    EXPECT_LE(bytes, 25e6);
}

} // namespace
} // namespace relume
