// These tests say what the bake is asked for, so that a view has something to show.
#include "app/viewer/picture/inspection.h"
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

} // namespace
} // namespace relume
