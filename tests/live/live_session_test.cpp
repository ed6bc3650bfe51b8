// This tests the session where a device says what it has room for.
#include "app/live/session.h"
#include "tests/live/live_bake_fixture.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace relume {
namespace {

// Sizes are found from the one that was asked for, whatever the scene before needed.
TEST_F(LiveBakeTest, EachSceneThatIsOpenedGetsASizeOfItsOwn) {
    BakeRequest wanted;
    wanted.bake = quickSettings();
    wanted.prepare.leastDensity = 10; // [texels/m]
    const std::string scenes = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/";
    const std::string large = scenes + "atrium.glb", small = scenes + "cornell_small.glb";
    Session session(bake_, wanted);
    std::vector<uint32_t> sizes;
    for (const std::string& path : {small, large, small}) {
        session.open(path);
        ASSERT_TRUE(until([&] { return session.update(); })) << path;
        ASSERT_EQ(session.path(), path);
        sizes.push_back(session.document().bake.size);
    }
    bake_.stop(); // it reads the session's scenes
    ASSERT_GT(sizes[1], sizes[0]) << "the test's scenes differ in what they need";
    EXPECT_EQ(sizes[2], sizes[0]);
}

} // namespace
} // namespace relume
