// These tests open exported levels in Blender without a window, by the code that comes with them.
#include "assets/images/image_file.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

const std::string kLevel = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/octagon.glb";
const std::string kShowLevel = std::string(RELUME_SOURCE_DIR) + "/tests/blender/show_level.py";

class ExportedLevel : public testing::Test {
protected:
    void SetUp() override {
        if (runProgram("/usr/bin/env", {"blender", "--version"}).status != 0)
            GTEST_SKIP() << "Blender is not there: install Debian's packages blender and python3-numpy";
    }
    /// Exports the level with its light on so many pages, and returns how Blender shows it.
    FloatImage picture(const std::string& pages) const {
        constexpr double kLimit = 240; // [s]
        const std::string folder = folder_.path("on" + pages), image = folder + "/picture.exr";
        const ProcessResult exported =
            runRelume({"export", kLevel, "--for", "blender", "--size", "128", "--pages", pages, "--samples",
                       "256", "--exposure", "0", "-o", folder});
        EXPECT_EQ(exported.status, 0) << exported.err;
        const ProcessResult shown = runProgram("/usr/bin/env",
                                               {"blender", "-b", "--python-exit-code", "1", "-P",
                                                folder + "/level.py", "-P", kShowLevel, "--", image},
                                               nullptr, kLimit);
        EXPECT_EQ(shown.status, 0) << shown.out << shown.err;
        return readImage(image);
    }

    TemporaryFolder folder_;
};

// An object that took its light from another page would show light of elsewhere, or none.
TEST_F(ExportedLevel, IsLitAlikeByOnePageAndBySeveral) {
    const FloatImage one = picture("1"), several = picture("3");
    ASSERT_EQ(one.width, several.width);
    double sum = 0, off = 0;
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float>&a = *one.find(channel), &b = *several.find(channel);
        ASSERT_EQ(a.size(), b.size());
        for (size_t i = 0; i < a.size(); ++i) {
            sum += double{a[i]};
            off += std::abs(double{a[i]} - double{b[i]});
        }
    }
    EXPECT_GT(sum, 0.0);
    EXPECT_LT(off / sum, 0.1); // texels are of another size
}

} // namespace
} // namespace relume
