// These tests look into what app/export/web writes: the container, its light, the page's files.
#include "app/export/web/web_container.h"
#include "app/export/web/web_light.h"
#include "app/export/web/web_page.h"
#include "app/export/web/web_scene.h"
#include "app/offline/light_mix.h"
#include "assets/base/error.h"
#include "assets/decode/webp.h"
#include "assets/images/image_file.h"
#include "assets/images/shared_exponent.h"
#include "tests/log_capture.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <limits>

namespace relume {
namespace {

using nlohmann::json;

/// Reads a container as the page does.
struct OpenedContainer {
    explicit OpenedContainer(const std::string& packed) {
        plain.resize(size_t{1} << 20);
        uLongf size = plain.size();
        EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(plain.data()), &size,
                             reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
                  Z_OK);
        plain.resize(size);
        EXPECT_EQ(plain.substr(0, 8), "RLMWEB01");
        uint32_t length = 0;
        for (size_t i = 0; i < 4; ++i)
            length |= uint32_t{static_cast<uint8_t>(plain[8 + i])} << (8 * i);
        header = json::parse(plain.substr(12, length));
        first = 12 + length;
    }
    template<class T>
    std::vector<T> values(int number) const {
        const json& section = header["sections"][static_cast<size_t>(number)];
        const auto bytes = section["bytes"].get<size_t>(), stride = section["stride"].get<size_t>();
        const std::string_view from =
            std::string_view(plain).substr(first + section["offset"].get<size_t>(), bytes);
        std::string sorted(bytes, '\0');
        for (size_t i = 0; i < bytes; ++i)
            sorted[i % (bytes / stride) * stride + i / (bytes / stride)] = from[i];
        std::vector<T> out(bytes / sizeof(T));
        std::memcpy(out.data(), sorted.data(), bytes);
        return out;
    }

    std::string plain;
    json header;
    size_t first = 0;
};

LayeredImage::Layer lampLayer(const std::string& name, float brightness) {
    LayeredImage::Layer layer{name, glm::vec3(2.0f, 1.0f, 0.5f), {}, {}};
    layer.attributes[layer_attribute::kType] = "point";
    layer.attributes[layer_attribute::kUnit] = "cd";
    layer.attributes[layer_attribute::kIntensity] = "2";
    layer.attributes[layer_attribute::kColor] = "1,0.5,0.25";
    layer.image.width = layer.image.height = 4;
    for (const char* channel : {"R", "G", "B"})
        layer.image.add(channel).assign(16, brightness * (*channel == 'R' ? 1.0f : 0.3f));
    return layer;
}

LayeredImage fourLayers() {
    LayeredImage image;
    image.composite.width = image.composite.height = 4;
    for (const char* channel : {"R", "G", "B", "coverage"})
        image.composite.add(channel).assign(16, 1.0f);
    image.composite.planes[3][0] = 0.0f; // empty
    image.composite.planes[3][1] = 0.5f; // filled
    for (const float brightness : {1e-6f, 0.7f, 300.0f, 2e6f})
        image.layers.push_back(lampLayer("Lamp " + std::to_string(image.layers.size() + 1), brightness));
    return image;
}

TEST(WebContainer, SectionsComeBackAsTheyWereAdded) {
    WebContainer container;
    const std::vector<float> floats = {1.5f, -2.25f, 0.0f, 3e8f, 1e-20f};
    const std::vector<uint8_t> marks = {1, 0, 1};
    const int bytes = container.add("any bytes"),
              numbers = container.addValues(std::span<const float>(floats)),
              few = container.addValues(std::span<const uint8_t>(marks)),
              none = container.addValues(std::span<const float>());
    container.header["name"] = "gallery";
    const OpenedContainer opened(container.packed());
    EXPECT_EQ(opened.header["name"], "gallery");
    const std::vector<char> text = opened.values<char>(bytes);
    EXPECT_EQ(std::string(text.begin(), text.end()), "any bytes");
    EXPECT_EQ(opened.values<float>(numbers), floats);
    EXPECT_EQ(opened.values<uint8_t>(few), marks);
    EXPECT_EQ(opened.header["sections"][static_cast<size_t>(none)]["bytes"], 0);
}

TEST(WebContainer, Base64IsThatOfTheStandard) { // RFC 4648, section 10
    const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}};
    for (const auto& [bytes, text] : vectors)
        EXPECT_EQ(base64Of(bytes), text);
    EXPECT_EQ(base64Of("\xff\xfe\xfd"), "//79");
}

// A file's name may be any bytes, and so may a light's in a file of layers; JSON is UTF-8.
TEST(WebPage, NamesThatAreNoUtf8AreShownByReplacementCharacters) {
    const TemporaryFolder folder;
    Scene scene;
    scene.path = "rooms/caf\xe9.glb";
    scene.cameras.push_back({.name = "Door"});
    LayeredImage image = fourLayers();
    image.layers[0].name = "L\xe4mp";
    const WebDesc desc{.path = folder.path("page.html"), .single = true, .frames = {}};
    EXPECT_NO_THROW(writeWebPage(desc, scene, WorldMesh(), image, "l\xe9.exr"));
    EXPECT_TRUE(contains(bytesOf(desc.path), "relume.start("));
    WebContainer container;
    container.header["name"] = "caf\xe9";
    addLight(container, image, "l\xe9.exr");
    const OpenedContainer opened(container.packed());
    EXPECT_EQ(opened.header["name"], "caf\xef\xbf\xbd");
    EXPECT_EQ(opened.header["lights"][0]["name"], "L\xef\xbf\xbdmp");
}

TEST(WebLight, EveryLayerKeepsItsLightWhateverItsBrightness) {
    const LayeredImage image = fourLayers();
    WebContainer container;
    addLight(container, image, "layers.exr");
    const OpenedContainer opened(container.packed());
    for (size_t i = 0; i < image.layers.size(); ++i) {
        const json& light = opened.header["lights"][i];
        const std::vector<uint32_t> texels = opened.values<uint32_t>(light["texels"]);
        ASSERT_EQ(texels.size(), 16u);
        EXPECT_EQ(texels[0], 0u) << "an empty texel brings light";
        for (size_t t = 1; t < texels.size(); ++t)
            for (int c = 0; c < 3; ++c) {
                const float right = image.layers[i].image.planes[static_cast<size_t>(c)][t];
                const float most = image.layers[i].image.planes[0][t];
                const float read =
                    std::ldexp(unpackSharedExponent(texels[t])[c], light["exponent"].get<int>());
                EXPECT_NEAR(read, right, most / 512) << i << " " << t << " " << c;
            }
        EXPECT_NEAR(light["mean"][0].get<double>() / double(image.layers[i].image.planes[0][5]), 1.0, 1e-6);
        EXPECT_EQ(light["intensity"], 2.0f);
        EXPECT_EQ(light["color"], json({1.0f, 0.5f, 0.25f}));
        EXPECT_EQ(light["weight"], json({2.0f, 1.0f, 0.5f}));
        EXPECT_EQ(light["unit"], "cd");
    }
    const std::vector<uint8_t> coverage = opened.values<uint8_t>(opened.header["lightmap"]["coverage"]);
    EXPECT_EQ(coverage[0], 0);
    EXPECT_EQ(coverage[1], 128);
    EXPECT_EQ(coverage[2], 255);
}

TEST(WebLight, BrokenLayersAreToldByFileAndName) {
    LayeredImage broken = fourLayers();
    broken.layers[2].image.planes[1][7] = std::numeric_limits<float>::quiet_NaN();
    const auto message = [](const LayeredImage& image) {
        try {
            WebContainer container;
            addLight(container, image, "layers.exr");
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(message(broken),
              "layers.exr: the layer of 'Lamp 3' holds a value that is not finite: bake it again");
    LayeredImage wide = fourLayers();
    wide.composite.width = 8;
    wide.composite.height = 2;
    EXPECT_EQ(message(wide), "layers.exr: has 8 x 2 texels, and a lightmap is a square: bake one");
}

TEST(WebLight, LampsThatShareALayerAreFoundInIt) {
    Scene scene;
    for (const char* name : {"Left", "Right", "Other", "New"})
        scene.lights.push_back({.name = name});
    LayeredImage image = fourLayers();
    image.layers[0].name = "2 lights";
    image.layers[0].attributes[layer_attribute::kMembers] = "Left\nRight";
    image.layers[1].name = "Other";
    const LightLayers layers(scene, image);
    EXPECT_EQ(layers.of({LightKey::Kind::Lamp, 0, 0}), 0);
    EXPECT_EQ(layers.of({LightKey::Kind::Lamp, 1, 0}), 0);
    EXPECT_EQ(layers.of({LightKey::Kind::Lamp, 2, 0}), 1);
    EXPECT_EQ(layers.of({LightKey::Kind::Lamp, 3, 0}), -1);
    EXPECT_EQ(layers.of({LightKey::Kind::Sky, 0, 0}), -1);
}

TEST(WebLight, FramesAreSpreadEvenlyWithBothEnds) {
    EXPECT_EQ(evenlySpread(0, 3), std::vector<size_t>{});
    EXPECT_EQ(evenlySpread(1, 3), std::vector<size_t>({0}));
    EXPECT_EQ(evenlySpread(3, 3), std::vector<size_t>({0, 1, 2}));
    EXPECT_EQ(evenlySpread(9, 3), std::vector<size_t>({0, 4, 8}));
    const std::vector<size_t> many = evenlySpread(1000, 48);
    EXPECT_EQ(many.size(), 48u);
    EXPECT_EQ(many.front(), 0u);
    EXPECT_EQ(many.back(), 999u);
    for (size_t i = 1; i < many.size(); ++i)
        EXPECT_NEAR(double(many[i] - many[i - 1]), 999.0 / 47, 1.0);
}

TEST(WebScene, AnImageThatIsTooLargeForWebpIsMadeSmaller) {
    constexpr int kWide = 20000;
    Scene scene;
    scene.path = "wide.glb";
    Image image{"bricks", kWide, 1, {}};
    for (int x = 0; x < kWide; ++x)
        image.rgba.insert(image.rgba.end(), {200, 100, 50, 255});
    scene.images.push_back(std::move(image));
    scene.textures.push_back({.image = 0});
    scene.cameras.push_back({.name = "Door"});
    scene.materials.emplace_back().baseColorTexture.texture = 0;
    scene.materials.emplace_back().emissionTexture.texture = 0; // it is told once
    WebContainer container;
    const LogCapture log;
    addScene(container, scene, WorldMesh(), fourLayers());
    EXPECT_EQ(log.text().substr(log.text().find("wide.glb")),
              "wide.glb: image 0 'bricks': has 20000 x 1 pixels, more along a side than the 16383 that WebP "
              "takes: it is made smaller for it\n");
    const OpenedContainer opened(container.packed());
    const auto picture = opened.values<uint8_t>(opened.header["textures"][0]["picture"].get<int>());
    const std::optional<std::vector<uint8_t>> pixels = decodeWebp(picture);
    ASSERT_TRUE(pixels);
    ASSERT_EQ(pixels->size(), size_t{4} * 16383);
    EXPECT_EQ(webpSize(picture)->width, 16383u);
    for (size_t c = 0; c < 4; ++c)
        EXPECT_EQ((*pixels)[4 * 8000 + c], scene.images[0].rgba[c]);
}

TEST(WebPage, FramesOfATimelapseAreFoundInOrder) {
    const TemporaryFolder folder;
    EXPECT_THROW(framesIn(folder.path()), Error);
    EXPECT_THROW(framesIn(folder.path("missing")), Error);
    for (const char* name : {"frame_10000.png", "frame_0002.png", "frame_9999.png", "other.png"})
        std::ofstream(folder.path(name)) << "";
    EXPECT_EQ(framesIn(folder.path()),
              std::vector<std::string>({folder.path("frame_0002.png"), folder.path("frame_9999.png"),
                                        folder.path("frame_10000.png")}));
}

TEST(WebPage, PagesNameNothingOutsideAndAreWholeInOneFile) {
    const TemporaryFolder folder;
    Scene scene;
    scene.path = "rooms/a <b> & c.glb";
    scene.cameras.push_back({.name = "Door"});
    const WorldMesh mesh;
    FloatImage frame{2, 2, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        frame.add(channel).assign(4, 0.5f);
    writeImage(folder.path("frame_0001.png"), frame);
    const WebDesc apart{.path = folder.path("page"), .frames = framesIn(folder.path())};
    const WebDesc single{.path = folder.path("page.html"), .single = true, .exposure = 1.5f, .frames = {}};
    for (const WebDesc& desc : {apart, single}) {
        checkWebPage(desc);
        writeWebPage(desc, scene, mesh, fourLayers(), "layers.exr");
        for (const std::string& path : webFiles(desc)) {
            const std::string text = bytesOf(path);
            EXPECT_FALSE(text.empty()) << path;
            for (const char* outside : {"http:", "https:", "fetch(", "import ", "@NAME@", "@lib/"})
                EXPECT_FALSE(contains(text, outside)) << path << ": " << outside;
        }
    }
    const std::string page = bytesOf(folder.path("page/index.html")), whole = bytesOf(single.path);
    EXPECT_TRUE(contains(page, "<h1>a &lt;b> &amp; c</h1>"));
    EXPECT_TRUE(contains(page, "<script src=\"scene.js\"></script>"));
    EXPECT_FALSE(contains(whole, "<script src"));
    EXPECT_FALSE(contains(whole, "<link rel=\"stylesheet\""));
    EXPECT_TRUE(contains(whole, "relume.start(\""));
    EXPECT_EQ(webFiles(single), std::vector<std::string>({single.path}));
}

} // namespace
} // namespace relume
