// These tests say what the bake is asked for, so that a view has something to show.
#include "app/viewer/picture/inspection.h"
#include "app/viewer/picture/texel_readout.h"
#include "app/viewer/state/views.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

ViewState viewOf(const char* name) {
    ViewState view;
    view.view = viewIndex(name);
    return view;
}

TEST(Inspection, AViewAsksForItsMap) {
    const LightList none;
    EXPECT_EQ(inspectionOf(viewOf("lit"), none, {}), InspectRequest{});
    EXPECT_EQ(inspectionOf(viewOf("albedo"), none, {}), InspectRequest{}) << "it reads no map";
    ViewState view = viewOf("ligIn");
    view.mip = 2;
    EXPECT_EQ(inspectionOf(view, none, {})->content, MapContent::LigIn);
    EXPECT_EQ(inspectionOf(view, none, {})->mip, 2u);
    view.view = viewIndex("nrm");
    EXPECT_EQ(inspectionOf(view, none, {})->mip, 0u) << "normals have no mips";
}

TEST(Inspection, NothingIsAskedForWhatIsNotChosenYet) {
    const LightList none;
    ViewState view = viewOf("seen");
    EXPECT_EQ(inspectionOf(view, none, {}), std::nullopt);
    view.seenTexel = 17;
    EXPECT_EQ(inspectionOf(view, none, {})->texel, 17u);
    view.view = viewIndex("layer");
    EXPECT_EQ(inspectionOf(view, none, {}), std::nullopt);
    view.light = LightKey{LightKey::Kind::Lamp, 0, 0};
    EXPECT_EQ(inspectionOf(view, none, {}), std::nullopt) << "the light is gone";
}

TEST(TexelReadout, TellsAnErrorByTwoDigits) {
    const auto told = [](float value, float unit = 1.0f) {
        return texelErrorText({value, value, value, 1.0f}, unit, true);
    };
    EXPECT_EQ(told(0.032f), "local error 3.2 %");
    EXPECT_EQ(told(0.0032f), "local error 0.32 %");
    EXPECT_EQ(told(0.32f), "local error 32 %");
    EXPECT_EQ(told(0.16f, 2.0f), "local error 32 %") << "of a map in units of its own";
    EXPECT_EQ(told(0.0f), "local error 0 %");
    EXPECT_EQ(told(3e-7f), "local error 0.000 %");
}

TEST(TexelReadout, TellsWhereThereIsNoError) {
    EXPECT_EQ(texelErrorText({0.1f, 0.1f, 0.1f, 0.5f}, 1.0f, true), "no patch") << "it is filled";
    EXPECT_EQ(texelErrorText(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f), 1.0f, false), "no error is told");
}

TEST(UvView, FindsThePixelOfAUv) {
    const UvWindow window{.centre = {0.3f, 0.6f}, .zoom = 2.5f};
    const glm::vec2 size(640.0f, 360.0f), pixel(123.0f, 45.0f);
    const glm::vec2 found = pixelAt(window, uvAt(window, pixel, size), size);
    EXPECT_NEAR(found.x, pixel.x, 1e-2f);
    EXPECT_NEAR(found.y, pixel.y, 1e-2f);
}

} // namespace
} // namespace relume
