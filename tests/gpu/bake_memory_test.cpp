// This checks how much of the device's memory a bake takes.
#include "bake/baker/baker.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

namespace relume {

TEST(BakeMemory, ASizeThatDoesNotFitIsRefusedWithOneThatDoes) {
    const vk::Device& device = testDevice();
    BakeSettings settings;
    settings.size = 2048;
    constexpr uint64_t kTriangles = 1000, kLimit = uint64_t{512} << 20;
    const std::string problem = Baker::sizeProblem(device, settings, kTriangles, kLimit);
    ASSERT_TRUE(problem.ends_with(" fits")) << problem;
    const size_t end = problem.rfind(" fits"), begin = problem.rfind(' ', end - 1);
    const auto fits = static_cast<uint32_t>(std::stoul(problem.substr(begin, end - begin)));
    EXPECT_GE(fits, 64u);
    EXPECT_LT(fits, settings.size);
    settings.size = fits;
    EXPECT_EQ(Baker::sizeProblem(device, settings, kTriangles, kLimit), "");
    settings.size = fits + 64;
    EXPECT_NE(Baker::sizeProblem(device, settings, kTriangles, kLimit), "");
    EXPECT_NE(Baker::sizeProblem(device, settings, kTriangles, 0).find("no size fits"), std::string::npos);
}

} // namespace relume
