// These tests say what is held of keyboard and mouse, and what comes of it.
#include "app/viewer/state/held_input.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

namespace relume {
namespace {

using Release = HeldInput::Release;

WindowEvent keyEvent(int code, int mods = 0, bool pressed = true, bool repeated = false) {
    return {.kind = WindowEvent::Kind::Key,
            .code = code,
            .place = code,
            .mods = mods,
            .pressed = pressed,
            .repeated = repeated};
}

const Shortcut* meant(const WindowEvent& event, bool typing = false, bool fileDialog = false) {
    return meantShortcut(event, {.typing = typing, .fileDialog = fileDialog});
}

TEST(HeldInput, KeysOfFlightAddUp) {
    HeldInput input;
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_W), false));
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_D), false));
    EXPECT_EQ(input.flight().held, glm::ivec3(1, 0, 1));
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_A), false));
    EXPECT_EQ(input.flight().held, glm::ivec3(0, 0, 1)) << "left and right at once is neither";
    EXPECT_FALSE(input.takeFlightKey(keyEvent(GLFW_KEY_D, 0, false), false));
    EXPECT_EQ(input.flight().held, glm::ivec3(-1, 0, 1));
    input.releaseKeys();
    EXPECT_EQ(input.flight().held, glm::ivec3(0));
}

TEST(HeldInput, ARepeatedKeyFliesOnce) {
    HeldInput input;
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_W), false));
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_W, 0, true, true), false));
    EXPECT_EQ(input.flight().held, glm::ivec3(0, 0, 1));
}

TEST(HeldInput, NothingFliesWhileOneTypesOrHoldsCtrl) {
    HeldInput input;
    EXPECT_FALSE(input.takeFlightKey(keyEvent(GLFW_KEY_S), true));
    EXPECT_FALSE(input.takeFlightKey(keyEvent(GLFW_KEY_S, GLFW_MOD_CONTROL), false)) << "it saves";
    EXPECT_FALSE(input.takeFlightKey(keyEvent(GLFW_KEY_X), false));
    EXPECT_EQ(input.flight().held, glm::ivec3(0));
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_S, GLFW_MOD_SHIFT), false));
}

TEST(HeldInput, AKeyThatGetsCtrlOnTheWayFliesNoMore) {
    HeldInput input;
    EXPECT_TRUE(input.takeFlightKey(keyEvent(GLFW_KEY_S), false));
    EXPECT_FALSE(input.takeFlightKey(keyEvent(GLFW_KEY_S, GLFW_MOD_CONTROL, true, true), false));
    EXPECT_EQ(input.flight().held, glm::ivec3(0));
}

TEST(HeldInput, APressOfCtrlItselfHoldsIt) {
    HeldInput input;
    input.followModifiers(keyEvent(GLFW_KEY_LEFT_CONTROL)); // no modifier of its own press ...
    EXPECT_TRUE(input.control());
    input.followModifiers(keyEvent(GLFW_KEY_LEFT_CONTROL, GLFW_MOD_CONTROL, false)); // ... but of its release
    EXPECT_FALSE(input.control());
    input.followModifiers(keyEvent(GLFW_KEY_X, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT));
    EXPECT_TRUE(input.control());
    EXPECT_TRUE(input.flight().fast);
}

TEST(HeldInput, AClickThatTremblesIsNoDrag) {
    HeldInput input;
    EXPECT_FALSE(input.drag({10, 10})) << "no button is pressed";
    input.press(GLFW_MOUSE_BUTTON_LEFT, {100, 100});
    EXPECT_FALSE(input.drag({103, 100}));
    EXPECT_EQ(input.release(GLFW_MOUSE_BUTTON_LEFT, {103, 100}), Release::Click);
    EXPECT_FALSE(input.pressed());
    EXPECT_EQ(input.cursor(), glm::dvec2(103, 100));
}

TEST(HeldInput, ADragCountsFromWhereItBegan) {
    HeldInput input;
    input.press(GLFW_MOUSE_BUTTON_LEFT, {100, 100});
    EXPECT_FALSE(input.drag({103, 100}));
    ASSERT_EQ(input.drag({106, 100}), glm::dvec2(6, 0)) << "the first 3 are not lost";
    ASSERT_EQ(input.drag({107, 101}), glm::dvec2(1, 1)) << "it need not go so far again";
    EXPECT_EQ(input.release(GLFW_MOUSE_BUTTON_RIGHT, {120, 100}), Release::Nothing);
    EXPECT_TRUE(input.pressed());
    EXPECT_EQ(input.release(GLFW_MOUSE_BUTTON_LEFT, {120, 100}), Release::Drag);
    EXPECT_EQ(input.release(GLFW_MOUSE_BUTTON_LEFT, {120, 100}), Release::Nothing);
}

TEST(HeldInput, ButtonsDragTheCamera) {
    using Drag = CameraControl::Drag;
    EXPECT_EQ(cameraDragOf(GLFW_MOUSE_BUTTON_LEFT, 0), Drag::Orbit);
    EXPECT_EQ(cameraDragOf(GLFW_MOUSE_BUTTON_LEFT, GLFW_MOD_SHIFT), Drag::Pan);
    EXPECT_EQ(cameraDragOf(GLFW_MOUSE_BUTTON_MIDDLE, 0), Drag::Pan);
    EXPECT_EQ(cameraDragOf(GLFW_MOUSE_BUTTON_RIGHT, GLFW_MOD_SHIFT), Drag::Look);
    EXPECT_EQ(cameraDragOf(GLFW_MOUSE_BUTTON_4, 0), Drag::None);
    EXPECT_STREQ(cameraDragName(GLFW_MOUSE_BUTTON_LEFT, 0), "orbit");
    EXPECT_STREQ(cameraDragName(GLFW_MOUSE_BUTTON_LEFT, GLFW_MOD_SHIFT), "pan");
    EXPECT_STREQ(cameraDragName(GLFW_MOUSE_BUTTON_RIGHT, GLFW_MOD_SHIFT), "look");
}

TEST(MeantShortcut, OnlySomeKeysRepeat) {
    EXPECT_NE(meant(keyEvent(GLFW_KEY_Z, GLFW_MOD_CONTROL, true, true)), nullptr);
    EXPECT_NE(meant(keyEvent(GLFW_KEY_B)), nullptr);
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_B, 0, true, true)), nullptr) << "a wipe that flickers";
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_B, 0, false)), nullptr) << "a release";
}

TEST(MeantShortcut, LettersGoToTheTextWhileOneTypes) {
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_B), true), nullptr);
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_Z, GLFW_MOD_CONTROL), true), nullptr);
    EXPECT_NE(meant(keyEvent(GLFW_KEY_F12), true), nullptr);
    EXPECT_NE(meant(keyEvent(GLFW_KEY_Q, GLFW_MOD_CONTROL), true), nullptr) << "one can always quit";
}

TEST(MeantShortcut, KeysThatGoThroughControlsDoNothingElse) {
    const KeyFocus page{.page = true};
    EXPECT_EQ(meantShortcut(keyEvent(GLFW_KEY_SPACE), page), nullptr) << "it presses, and does not pause";
    EXPECT_NE(meantShortcut(keyEvent(GLFW_KEY_SPACE), {}), nullptr);
    EXPECT_NE(meantShortcut(keyEvent(GLFW_KEY_LEFT, GLFW_MOD_ALT), page), nullptr);
    EXPECT_NE(meantShortcut(keyEvent(GLFW_KEY_O, GLFW_MOD_CONTROL), page), nullptr);
    EXPECT_NE(meantShortcut(keyEvent(GLFW_KEY_ESCAPE), page), nullptr);
    for (const int key : {GLFW_KEY_UP, GLFW_KEY_DOWN, GLFW_KEY_LEFT, GLFW_KEY_RIGHT, GLFW_KEY_TAB,
                          GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER})
        EXPECT_TRUE(goesThroughControls(keyEvent(key))) << key;
    EXPECT_TRUE(goesThroughControls(keyEvent(GLFW_KEY_TAB, GLFW_MOD_SHIFT)));
    EXPECT_FALSE(goesThroughControls(keyEvent(GLFW_KEY_TAB, GLFW_MOD_CONTROL)));
}

TEST(MeantShortcut, EscLeavesAFieldOrClosesADialog) {
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_ESCAPE), true), nullptr);
    ASSERT_NE(meant(keyEvent(GLFW_KEY_ESCAPE), true, true), nullptr);
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_ESCAPE), true, true)->action, Action::Close);
    EXPECT_EQ(meant(keyEvent(GLFW_KEY_B), true, true), nullptr);
}

} // namespace
} // namespace relume
