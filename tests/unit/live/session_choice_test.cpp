#include "app/live/session.h"

#include "tests/unit/glb_builder.h"
#include "tests/unit/session_fixture.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST_F(SessionTest, AChoiceOfTheFilesScenesLastsUntilAnotherFile) {
    test::GlbBuilder builder = test::squareScene();
    builder.node({{"mesh", 0}, {"name", "Second"}, {"translation", {0, 0, 2}}});
    builder.json["scenes"] = {{{"name", "One"}, {"nodes", {0}}}, {{"name", "Two"}, {"nodes", {0, 1}}}};
    const std::string two = builder.write("two_scenes.glb");
    writeFile(two);
    const auto objects = [this] { return session_.scene()->prepared.scene.instances.size(); };
    open();
    EXPECT_EQ(objects(), 1u);
    EXPECT_EQ(session_.scene()->prepared.scene.sceneNames, (std::vector<std::string>{"One", "Two"}));
    session_.choose({.scene = "Two"});
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(objects(), 2u);
    writeFile(two); // an exporter writes the file anew
    session_.open(file(), true);
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(objects(), 2u);
    EXPECT_EQ(session_.choice().scene, "Two");
    session_.choose({.scene = "Three"});
    ASSERT_TRUE(untilLoaded());
    const std::optional<OpenFailure> failure = session_.takeOpenFailure();
    ASSERT_TRUE(failure);
    EXPECT_NE(failure->message.find("has no scene 'Three': it has 'One', 'Two'"), std::string::npos);
    EXPECT_EQ(session_.choice().scene, "Two"); // the scene before stays
    session_.open(two);
    ASSERT_TRUE(untilLoaded());
    EXPECT_EQ(objects(), 1u);
    EXPECT_EQ(session_.choice().scene, "");
}

} // namespace
} // namespace relume
