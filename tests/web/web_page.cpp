#include "tests/web/web_page.h"

#include "assets/images/image_file.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace relume {
namespace {

namespace fs = std::filesystem;

const std::string kFolder = std::string(RELUME_SOURCE_DIR) + "/tests/web/";

std::string chromium() {
    const char* named = std::getenv("CHROMIUM");
    return named != nullptr ? named : "/usr/bin/chromium";
}

ProcessResult runNode(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "node");
    constexpr double kLimit = 300; // [s]
    return runProgram("/usr/bin/env", arguments, nullptr, kLimit);
}

} // namespace

std::string whyNoPages() {
    if (!fs::exists(kFolder + "node_modules/three"))
        return "the npm packages of tests/web are not installed: run ./test.sh web";
    if (runNode({"--version"}).status != 0) return "Node.js is not there: run ./test.sh web";
    if (!fs::exists(chromium())) return chromium() + " is not there: run ./test.sh web";
    return "";
}

FloatImage pictureOfPage(const std::string& folder, const std::string& page, uint32_t width,
                         uint32_t height) {
    const TemporaryFolder pictures;
    const std::string picture = pictures.path("page.png");
    const ProcessResult run = runNode(
        {kFolder + "show.mjs", folder, page, picture, std::to_string(width) + "x" + std::to_string(height)});
    EXPECT_EQ(run.status, 0) << page << ": " << run.err;
    return run.status == 0 ? readImage(picture) : FloatImage{};
}

std::string complaintsAbout(const std::vector<std::string>& files) {
    std::vector<std::string> arguments = {kFolder + "validate.cjs"};
    arguments.insert(arguments.end(), files.begin(), files.end());
    const ProcessResult run = runNode(arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.out;
}

} // namespace relume
