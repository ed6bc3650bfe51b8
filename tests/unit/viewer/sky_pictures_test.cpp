// This says whose picture of the sky it is that is read beside the main thread.
#include "app/viewer/picture/sky_pictures.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

namespace relume {
namespace {

class SkyPicturesTest : public testing::Test {
protected:
    std::string picture(const char* name) const {
        FloatImage image{.width = 4, .height = 2, .channels = {}, .planes = {}, .attributes = {}};
        for (const char* channel : {"R", "G", "B"}) {
            std::vector<float>& plane = image.add(channel);
            std::fill(plane.begin(), plane.end(), 1.0f);
        }
        writeImage(folder_.path(name), image);
        return folder_.path(name);
    }
    std::optional<SkyPictures::Result> within(double seconds) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (std::chrono::steady_clock::now() < end) {
            if (std::optional<SkyPictures::Result> result = pictures_.poll()) return result;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return std::nullopt;
    }

    const TemporaryFolder folder_;
    SkyPictures pictures_;
};

TEST_F(SkyPicturesTest, TheNewestOneIsTold) {
    pictures_.read(picture("a.exr"), false);
    pictures_.read(picture("b.exr"), true);
    const std::optional<SkyPictures::Result> result = within(60);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->sky.file, folder_.path("b.exr"));
    EXPECT_TRUE(result->chosen);
    EXPECT_EQ(pictures_.reading(), "");
}

TEST_F(SkyPicturesTest, OneThatIsForgottenIsNot) {
    pictures_.read(picture("a.exr"), true);
    pictures_.forget();
    EXPECT_EQ(pictures_.reading(), "");
    EXPECT_FALSE(within(0.3));
    pictures_.read(picture("b.exr"), true);
    pictures_.forget();
    pictures_.read(picture("c.exr"), false);
    const std::optional<SkyPictures::Result> result = within(60);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->sky.file, folder_.path("c.exr"));
    EXPECT_FALSE(result->chosen);
}

} // namespace
} // namespace relume
