#include "app/offline/light_mix.h"

#include "app/offline/layer_file.h"
#include "app/offline/name_lines.h"
#include "assets/base/error.h"

#include <gtest/gtest.h>

#include <functional>

namespace relume {
namespace {

LayeredImage::Layer layer(const char* name, const glm::vec3& weight, const std::vector<float>& texels) {
    LayeredImage::Layer made{name, weight, {}, {2, 1, {}, {}, {}}};
    for (int c = 0; c < 3; ++c)
        made.image.add(std::string(1, "RGB"[c])) = {texels[0] * float(c + 1), texels[1]};
    return made;
}

/// Makes a light whose colour and intensity are known, one that is off, and a sky of which only the weight is
/// known.
LayeredImage board() {
    LayeredImage image;
    image.composite = {2, 1, {}, {}, {}};
    for (const char* channel : {"R", "G", "B", "coverage", "stderr"})
        image.composite.add(channel) = {0.5f, 1.0f};
    image.layers = {layer("Lamp", {40, 20, 10}, {0.01f, 0.5f}), layer("Off", {0, 0, 0}, {3, 4}),
                    layer("Sky", {1, 2, 4}, {0.25f, 0.125f})};
    image.layers[0].attributes = {{layer_attribute::kIntensity, "20"}, {layer_attribute::kColor, "2,1,0.5"}};
    image.layers[1].attributes = {{layer_attribute::kIntensity, "7"}, {layer_attribute::kColor, "1,0.5,0"}};
    return image;
}

glm::vec3 texel(const LayeredImage& image, size_t index) {
    return {image.composite.planes[0][index], image.composite.planes[1][index],
            image.composite.planes[2][index]};
}

void expectSameColor(const glm::vec3& a, const glm::vec3& b) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a[c], b[c], 1e-6f * std::abs(b[c]));
}

MixDesc sets(const std::vector<std::string>& texts) {
    MixDesc desc;
    for (const std::string& text : texts)
        desc.edits.push_back(weightEditOf(text));
    return desc;
}

std::string errorOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(LightMix, LightsOfAGroupCannotBeSetApart) {
    LayeredImage image = board();
    image.layers[0].name = "rest";
    image.layers[0].attributes = {{layer_attribute::kMembers, "Lamp 6\nLamp 7"}};
    EXPECT_EQ(membersOf(image.layers[0]), (std::vector<std::string>{"Lamp 6", "Lamp 7"}));
    EXPECT_EQ(membersOf(image.layers[2]), std::vector<std::string>());
    EXPECT_EQ(errorOf([&] { mixLayers(image, sets({"Lamp 7=3"})); }),
              "light 'Lamp 7' is part of 'rest' and cannot be set apart: set 'rest', or bake with more "
              "--layer-memory");
    EXPECT_EQ(errorOf([&] { mixLayers(image, {.edits = {}, .muted = {"Lamp 6"}, .solo = {}}); }),
              "light 'Lamp 6' is part of 'rest' and cannot be set apart: set 'rest', or bake with more "
              "--layer-memory");
    mixLayers(image, sets({"rest*=0.5"}));
    expectSameColor(image.layers[0].weight, {20, 10, 5});
}

// A light's name may have a line end, as any text of a glTF file.
TEST(LightMix, TellsNoErrorOfOtherWeightsThanThoseOfTheBake) {
    LayeredImage image = board();
    image.composite.attributes["relume:error"] = "0.01";
    mixLayers(image, sets({"Lamp*=1"}));
    EXPECT_EQ(image.composite.attributes.count("relume:error"), 1u) << "nothing changed";
    mixLayers(image, {.edits = {}, .muted = {}, .solo = {"Sky"}});
    EXPECT_EQ(image.composite.attributes.count("relume:error"), 0u);
}

TEST(LightMix, NamesOfAGroupMayHaveLineEnds) {
    const std::vector<std::string> names = {"two\nlines", "a\\nb", "\\", "Lamp 7"};
    Layer group;
    group.source.key.kind = LightKey::Kind::Group;
    group.source.name = "rest";
    for (const std::string& name : names) {
        group.members.emplace_back();
        group.members.back().name = name;
    }
    LayeredImage image = board();
    image.layers[0].name = "rest";
    image.layers[0].attributes = layerWithoutImage(Scene(), group).attributes;
    EXPECT_EQ(membersOf(image.layers[0]), names);
    EXPECT_EQ(errorOf([&] { mixLayers(image, sets({"two\nlines=3"})); }),
              "light 'two lines' is part of 'rest' and cannot be set apart: set 'rest', or bake with more "
              "--layer-memory");
    EXPECT_TRUE(errorOf([&] { mixLayers(image, sets({"two=3"})); }).starts_with("no light is called 'two'"));
}

TEST(NameLines, ComeBackAsTheyWere) {
    const std::vector<std::string> plain = {"Lamp 6", "Lamp 7"}, odd = {"\n", "a\\", "\\n\nb", "\xff"};
    EXPECT_EQ(linesOf(plain), "Lamp 6\nLamp 7\n");
    EXPECT_EQ(joinedLines(plain), "Lamp 6\nLamp 7"); // the bytes that plain names always had
    for (const std::vector<std::string>& names : {plain, odd, {}}) {
        EXPECT_EQ(namesIn(linesOf(names)), names);
        EXPECT_EQ(namesIn(joinedLines(names)), names);
    }
}

TEST(LightMix, TheSumIsThatOfWeightedLayers) {
    LayeredImage image = board();
    mixLayers(image, {});
    expectSameColor(texel(image, 0), {40 * 0.01f + 1 * 0.25f, 20 * 0.02f + 2 * 0.5f, 10 * 0.03f + 4 * 0.75f});
    expectSameColor(texel(image, 1), {40 * 0.5f + 0.125f, 20 * 0.5f + 0.25f, 10 * 0.5f + 0.5f});
    EXPECT_EQ(image.composite.channels, (std::vector<std::string>{"R", "G", "B", "coverage"}));
    EXPECT_EQ(*image.composite.find("coverage"), (std::vector<float>{0.5f, 1}));
    const LayeredImage once = image;
    mixLayers(image, {});
    EXPECT_EQ(image.composite.planes, once.composite.planes);
}

TEST(LightMix, AnIntensityKeepsTheColor) {
    LayeredImage image = board();
    mixLayers(image, sets({"Lamp=2.5", "Sky=2"}));
    EXPECT_EQ(image.layers[0].weight, glm::vec3(5, 2.5f, 1.25f));
    EXPECT_EQ(image.layers[2].weight, glm::vec3(0.5f, 1, 2)); // its brightest channel
    EXPECT_EQ(intensityOf(image.layers[0]), 2.5f);
    EXPECT_EQ(colorOf(image.layers[0]), glm::vec3(2, 1, 0.5f));
    mixLayers(image, sets({"Lamp*=4", "Sky*=0"}));
    EXPECT_EQ(image.layers[0].weight, glm::vec3(20, 10, 5));
    EXPECT_EQ(intensityOf(image.layers[0]), 10.0f);
    EXPECT_EQ(image.layers[2].weight, glm::vec3(0));
    mixLayers(image, sets({"Sky=8"})); // its colour is remembered
    EXPECT_EQ(image.layers[2].weight, glm::vec3(2, 4, 8));
}

TEST(LightMix, ColorsAreSrgbInHexAndLinearAsNumbers) {
    LayeredImage image = board();
    mixLayers(image, sets({"Lamp=10,#ff8000", "Sky=2,1,0.5,0.25"}));
    EXPECT_EQ(image.layers[0].weight.r, 10.0f);
    EXPECT_NEAR(image.layers[0].weight.g, 2.158605f, 1e-5f);
    EXPECT_EQ(image.layers[0].weight.b, 0.0f);
    EXPECT_EQ(image.layers[2].weight, glm::vec3(2, 1, 0.5f));
}

TEST(LightMix, SwitchesTurnLightsOffAndOn) {
    LayeredImage image = board();
    MixDesc desc;
    desc.muted = {"Sky"};
    mixLayers(image, desc);
    expectSameColor(texel(image, 0), {0.4f, 0.4f, 0.3f});
    EXPECT_EQ(intensityOf(image.layers[2]), 4.0f); // what it had stays known
    EXPECT_EQ(colorOf(image.layers[2]), glm::vec3(0.25f, 0.5f, 1));

    image = board();
    desc = {};
    desc.solo = {"Sky", "Lamp"};
    desc.muted = {"Lamp"};
    mixLayers(image, desc);
    expectSameColor(texel(image, 0), {0.25f, 1.0f, 3.0f});
    EXPECT_EQ(intensityOf(image.layers[0]), 20.0f);

    image = board();
    mixLayers(image, sets({"Off*=2"}));
    EXPECT_EQ(image.layers[1].weight, glm::vec3(0)); // still off
    mixLayers(image, sets({"Off=7"}));
    EXPECT_EQ(image.layers[1].weight, glm::vec3(7, 3.5f, 0));
}

TEST(LightMix, WhatIsWrongIsNamed) {
    LayeredImage image = board();
    EXPECT_EQ(errorOf([&] { mixLayers(image, sets({"lamp=1"})); }),
              "no light is called 'lamp': did you mean 'Lamp'?");
    MixDesc desc;
    desc.solo = {"Window"};
    EXPECT_EQ(errorOf([&] { mixLayers(image, desc); }),
              "no light is called 'Window': there is 'Lamp', 'Off' and 'Sky'");
    for (const char* text : {"Lamp", "=2", "*=2", "Lamp*=2,#ffffff"})
        EXPECT_EQ(errorOf([&] { weightEditOf(text); }), "write NAME=INTENSITY[,COLOR] or NAME*=FACTOR")
            << text;
    EXPECT_EQ(errorOf([&] { weightEditOf("Lamp=-1"); }),
              "intensity -1 is out of range: give a number from 0 to 1e12");
    EXPECT_EQ(errorOf([&] { weightEditOf("Lamp=nan"); }),
              "'nan' is no intensity of finite numbers: give a number from 0 to 1e12");
    EXPECT_NE(errorOf([&] { weightEditOf("Lamp=1,#12"); }).find("'#12' is no color"), std::string::npos);
    EXPECT_NE(errorOf([&] {
                  mixLayers(image, sets({"Lamp=1e12", "Lamp*=1e12", "Lamp*=1e12", "Lamp*=1e12"}));
              }).find("becomes too bright"),
              std::string::npos);
}

} // namespace
} // namespace relume
