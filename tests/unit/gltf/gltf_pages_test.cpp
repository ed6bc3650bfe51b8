#include "assets/gltf/gltf.h"
#include "assets/model/lightmap_pages.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

using nlohmann::json;

// Reads a square whose node and scene tell of pages.
Scene pagedSquare(const json& pages, const json& page) {
    test::GlbBuilder builder = test::squareScene();
    builder.json["scenes"] = {{{"nodes", {0}}, {"extras", {{"relume", {{"pages", pages}}}}}}};
    builder.json["nodes"][0]["extras"]["relume"]["page"] = page;
    return loadGltf(builder.write("pages.glb"));
}

TEST(GltfPages, AreReadFromExtras) {
    const Scene scene = pagedSquare(4, 3);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.pages, 4u);
    EXPECT_EQ(scene.instances.at(0).page, 3u);
}

TEST(GltfPages, WhatIsWrongWithThemIsMendedAndWarnedAbout) {
    for (const json& pages : {json(0), json(65), json(-1), json(1.5), json("four"), json(nullptr)}) {
        const Scene scene = pagedSquare(pages, 0);
        EXPECT_EQ(scene.pages, 1u) << pages;
        ASSERT_EQ(scene.warnings.size(), 1u) << pages;
        EXPECT_NE(scene.warnings[0].find("none from 1 to 64, 1 is used"), std::string::npos);
    }
    for (const json& page : {json(4), json(-1), json(0.5), json("one"), json(nullptr)}) {
        const Scene scene = pagedSquare(4, page);
        EXPECT_EQ(scene.instances.at(0).page, 0u) << page;
        ASSERT_EQ(scene.warnings.size(), 1u) << page;
        EXPECT_NE(scene.warnings[0].find("none of the 4"), std::string::npos);
    }
}

} // namespace
} // namespace relume
