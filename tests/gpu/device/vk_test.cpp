#include "bake/vk/accel.h"
#include "bake/vk/commands.h"
#include "bake/vk/program.h"
#include "shaders/shader_library.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <numeric>

namespace relume {

namespace {

const std::string kTestShaders = RELUME_SOURCE_DIR "/tests/gpu/shaders";

// Lets shaders come from the tests' folder while it lives.
struct TestShaders {
    TestShaders() { setShaderFolder(kTestShaders); }
    ~TestShaders() { setShaderFolder(""); }
};

struct FillPush {
    VkDeviceAddress values;
    uint32_t count;
    uint32_t unused = 0;
};

std::vector<uint32_t> numbers(size_t count) {
    std::vector<uint32_t> values(count);
    std::iota(values.begin(), values.end(), 17u);
    return values;
}

std::vector<uint32_t> runFill(const vk::ComputeProgram& program, uint32_t count) {
    const vk::Device& device = testDevice();
    const vk::Buffer buffer(device, {.size = count * 4, .name = "filled"});
    vk::Commands commands(device);
    program.dispatch(commands.begin(), FillPush{buffer.address(), count}, (count + 63) / 64);
    commands.run();
    return vk::readBuffer<uint32_t>(device, buffer, count);
}

// Returns triangles over x in [i, i + 1], i = 0, 1, 2, 3.
std::vector<glm::vec3> fourTriangles() {
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 4; ++i) {
        const auto x = static_cast<float>(i);
        positions.insert(positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    }
    return positions;
}

} // namespace

TEST(VkDevice, IsListed) {
    const std::vector<vk::DeviceInfo> infos = vk::listDevices();
    const vk::DeviceInfo& mine = testDevice().info();
    ASSERT_LT(mine.index, infos.size());
    EXPECT_EQ(infos[mine.index].name, mine.name);
    EXPECT_EQ(infos[mine.index].uuid, mine.uuid);
    EXPECT_TRUE(mine.missing.empty());
    EXPECT_GT(testDevice().freeMemory(), 0u);
    EXPECT_LE(testDevice().freeMemory(), mine.deviceMemory);
}

TEST(VkDevice, UnknownNameSaysWhereToLook) {
    (void)testDevice();
    try {
        const vk::Device device({.select = "no such device", .validation = true});
        FAIL() << "found " << device.info().name;
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "device 'no such device' not found: 'relume devices' lists them");
    }
}

TEST(VkDevice, IsFoundByPartOfItsNameInAnyCase) {
    std::string part = testDevice().info().name.substr(1, 4);
    for (char& c : part)
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const vk::Device device({.select = part, .validation = true});
    EXPECT_NE(device.info().name.find(testDevice().info().name.substr(1, 4)), std::string::npos);
}

TEST(VkCheck, NamesCallAndResult) {
    try {
        vk::check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit(queue_, 1)");
        FAIL();
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind("vkQueueSubmit: VK_ERROR_DEVICE_LOST", 0), 0u) << message;
    }
    EXPECT_NO_THROW(vk::check(VK_NOT_READY, "vkGetFenceStatus"));
}

TEST(VkBuffer, RoundTripInBothMemories) {
    // These are 70 MB: the copy goes in several pieces where it is staged.
    const std::vector<uint32_t> values = numbers(17'500'003);
    for (vk::Memory memory : {vk::Memory::Device, vk::Memory::Host}) {
        vk::Buffer buffer(testDevice(), {.size = values.size() * 4, .memory = memory, .name = "round trip"});
        EXPECT_NE(buffer.address(), 0u);
        EXPECT_TRUE(memory == vk::Memory::Device || buffer.mapped() != nullptr);
        vk::upload(testDevice(), buffer, values.data(), buffer.size());
        EXPECT_EQ(vk::readBuffer<uint32_t>(testDevice(), buffer, values.size()), values);
        const std::vector<uint32_t> patch = {1, 2, 3};
        vk::upload(testDevice(), buffer, patch.data(), 12, 400);
        const vk::Buffer moved = std::move(buffer);
        EXPECT_EQ(vk::readBuffer<uint32_t>(testDevice(), moved, 5, 99),
                  (std::vector<uint32_t>{116, 1, 2, 3, 120}));
    }
}

TEST(VkBuffer, TakesElementsThatChangedAndNoOthers) {
    std::vector<uint32_t> values = numbers(3'000'001);
    for (vk::Memory memory : {vk::Memory::Device, vk::Memory::Host}) {
        const vk::Buffer buffer(testDevice(),
                                {.size = values.size() * 4, .memory = memory, .name = "elements"});
        vk::upload(testDevice(), buffer, values.data(), buffer.size());
        std::vector<uint32_t> wanted = values, changed;
        for (uint32_t i = 0; i < values.size(); i += i < 1000 ? 7 : i < 2'500'000 ? 1 : 1999) {
            changed.push_back(i);
            wanted[i] = values[i] = ~i;
        }
        changed.push_back(3'000'000);
        wanted.back() = values.back() = 5;
        vk::uploadElements(testDevice(), buffer, values, changed);
        EXPECT_EQ(vk::readBuffer<uint32_t>(testDevice(), buffer, values.size()), wanted);
        vk::uploadElements(testDevice(), buffer, values, {});
    }
    const auto parts = vk::partsOf(std::vector<uint32_t>{0, 1, 2, 1000, 2000, 2001}, 8);
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(parts[0].offset, 0u);
    EXPECT_EQ(parts[0].size, 24u);
    EXPECT_EQ(parts[1].offset, 8000u);
    EXPECT_EQ(parts[1].size, 8u);
    EXPECT_EQ(parts[2].offset, 16000u);
    EXPECT_EQ(parts[2].size, 16u);
}

TEST(VkBuffer, EmptyListHasAnAddress) {
    const vk::Buffer buffer = vk::makeBuffer(testDevice(), std::vector<float>{}, "empty");
    EXPECT_EQ(buffer.size(), 16u);
    EXPECT_NE(buffer.address(), 0u);
}

TEST(VkBuffer, TooLargeNamesBufferAndSize) {
    try {
        const vk::Buffer buffer(testDevice(), {.size = VkDeviceSize{1} << 46, .name = "bits"});
        FAIL();
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("'bits' of 67108864 MiB"), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
}

TEST(VkCommands, TimelineCountsSubmissions) {
    vk::Commands commands(testDevice());
    for (uint64_t i = 1; i <= 5; ++i) {
        vk::barrier(commands.begin());
        EXPECT_EQ(commands.submit(), i);
    }
    commands.wait(5);
    EXPECT_TRUE(commands.reached(5));
    EXPECT_FALSE(commands.reached(6));
}

TEST(VkCompute, DispatchesWithPushAndConstants) {
    const TestShaders shaders;
    const vk::ComputeProgram program(testDevice(), "fill", {5, 3});
    const std::vector<uint32_t> values = runFill(program, 1000);
    for (uint32_t i = 0; i < 1000; ++i)
        ASSERT_EQ(values[i], (i + 5) * 3);
    const std::vector<uint32_t> twice = runFill(vk::ComputeProgram(testDevice(), "fill_twice"), 100);
    for (uint32_t i = 0; i < 100; ++i)
        ASSERT_EQ(twice[i], 2 * i);
}

TEST(VkCompute, TimestampsGrow) {
    const TestShaders shaders;
    const vk::ComputeProgram program(testDevice(), "fill");
    const uint32_t count = 1 << 21;
    const vk::Buffer buffer(testDevice(), {.size = count * 4, .name = "filled"});
    vk::Commands commands(testDevice());
    vk::Timestamps timestamps(testDevice(), 2);
    VkCommandBuffer cmd = commands.begin();
    timestamps.reset(cmd);
    timestamps.mark(cmd, 0);
    program.dispatch(cmd, FillPush{buffer.address(), count}, (count + 63) / 64);
    timestamps.mark(cmd, 1);
    commands.run();
    EXPECT_GT(timestamps.milliseconds(0, 1), 0.0);
    EXPECT_LT(timestamps.milliseconds(0, 1), 10'000.0);
}

// A viewer that is killed has told the next one what its driver compiled.
TEST(VkDevice, KeepsItsPipelinesBeforeItEnds) {
    const TemporaryFolder folder;
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const std::string before = cache ? cache : "";
    setenv("XDG_CACHE_HOME", folder.path("").c_str(), 1);
    {
        const vk::Device device(vk::Device::Desc{});
        const TestShaders shaders;
        const vk::ComputeProgram program(device, "fill");
        EXPECT_FALSE(std::filesystem::exists(folder.path("relume")));
        device.keepPipelines();
        ASSERT_TRUE(std::filesystem::exists(folder.path("relume")));
        EXPECT_FALSE(std::filesystem::is_empty(folder.path("relume")));
    }
    if (cache)
        setenv("XDG_CACHE_HOME", before.c_str(), 1);
    else
        unsetenv("XDG_CACHE_HOME");
}

TEST(VkRay, AccelKeepsGeometriesApart) {
    const vk::Device& device = testDevice();
    if (!device.info().rayTracingPipeline)
        GTEST_SKIP() << device.info().name << " has no ray tracing pipeline";
    const TestShaders shaders;
    const vk::RayProgram program(device, {"ray_rgen", "ray_rmiss", "ray_rchit", "ray_rahit", {}});
    struct Push {
        VkDeviceAddress accel, result;
    };
    // For each count of opaque triangles, this holds geometry * 100 + index in it, and the hole where the
    // second masked one is.
    const std::pair<uint32_t, std::vector<uint32_t>> cases[] = {
        {4, {0, 1, 2, 3, 1000}}, {2, {0, 1, 100, 1000, 1000}}, {0, {100, 1000, 102, 103, 1000}}};
    for (const auto& [opaqueCount, expected] : cases) {
        vk::Accel accel(device, fourTriangles(), opaqueCount);
        EXPECT_GT(accel.bytes(), 0u);
        const vk::Accel moved = std::move(accel);
        const vk::Buffer result(device, {.size = 20, .name = "hits"});
        vk::Commands commands(device);
        program.trace(commands.begin(), Push{moved.address(), result.address()}, 5, 1);
        commands.run();
        EXPECT_EQ(vk::readBuffer<uint32_t>(device, result, 5), expected) << opaqueCount << " opaque";
    }
}

TEST(VkRay, AccelOfNothingIsNeverHit) {
    const vk::Device& device = testDevice();
    if (!device.info().rayTracingPipeline)
        GTEST_SKIP() << device.info().name << " has no ray tracing pipeline";
    const TestShaders shaders;
    const vk::RayProgram program(device, {"ray_rgen", "ray_rmiss", "", "", {}});
    const vk::Accel accel(device, {}, 0);
    const vk::Buffer result(device, {.size = 16, .name = "hits"});
    struct Push {
        VkDeviceAddress accel, result;
    };
    vk::Commands commands(device);
    program.trace(commands.begin(), Push{accel.address(), result.address()}, 4, 1);
    commands.run();
    EXPECT_EQ(vk::readBuffer<uint32_t>(device, result, 4), std::vector<uint32_t>(4, 1000));
}

TEST(VkRaster, DrawsIntoTwoTargetsAndSamplesTheLastMip) {
    const vk::Device& device = testDevice();
    const TestShaders shaders;
    // This is a texture of two mips whose 1 x 1 mip is the mean of 4 texels.
    const vk::Image2D texture(
        device, {.width = 2, .height = 2, .mips = 2, .usage = VK_IMAGE_USAGE_SAMPLED_BIT, .name = "texture"});
    const std::vector<uint8_t> texels = {0, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 255};
    vk::uploadPixels(device, texture, texels.data(), texels.size());
    const vk::Sampler sampler(device, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_REPEAT,
                              VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, 16.0f);
    const vk::RasterProgram::BoundTexture bound[] = {{texture.view(), sampler.handle()},
                                                     {texture.view(), sampler.handle()}};
    vk::RasterProgram program(device,
                              {.vertex = "target_vert",
                               .fragment = "target_frag",
                               .formats = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT},
                               .textureCount = 2},
                              bound);
    constexpr uint32_t size = 8;
    const vk::Image2D::Desc desc{.width = size,
                                 .height = size,
                                 .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                 .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                 .name = "target"};
    const vk::Image2D first(device, desc), second(device, desc);
    const vk::Image2D* targets[] = {&first, &second};
    const vk::Buffer pixels(device,
                            {.size = size * size * 16 * 2, .memory = vk::Memory::Host, .name = "pixels"});
    struct Push {
        float value;
        uint32_t texture;
    };
    vk::Commands commands(device);
    for (float value : {3.0f, 5.0f}) { // twice: the second draw must not race with the first one's copy
        VkCommandBuffer cmd = commands.begin();
        program.draw(cmd, Push{value, 1}, targets, 3);
        for (uint32_t i = 0; i < 2; ++i) {
            VkBufferImageCopy copy{};
            copy.bufferOffset = VkDeviceSize{i} * size * size * 16;
            copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            copy.imageExtent = {size, size, 1};
            vkCmdCopyImageToBuffer(cmd, targets[i]->handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                   pixels.handle(), 1, &copy);
        }
        vk::hostBarrier(cmd);
        commands.run();
    }
    const auto* values = static_cast<const glm::vec4*>(pixels.mapped());
    EXPECT_EQ(values[0].x, 5.0f);
    EXPECT_NEAR(values[0].y, 0.5f, 0.01f);        // no NaN where all fragments have one texture coordinate
    EXPECT_EQ(values[size - 1], glm::vec4(0.0f)); // not covered: cleared
    EXPECT_NEAR(values[size * size].x, 0.5f, 0.01f);
    EXPECT_EQ(values[size * size].y, 0.0f);
    EXPECT_EQ(values[size * size].w, 1.0f);
}

TEST(VkShaders, RuntimeErrorNamesFileAndLine) {
    const TestShaders shaders;
    try {
        (void)shaderCode("broken");
        FAIL();
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("broken.comp:4: "), std::string::npos) << message;
        EXPECT_NE(message.find("nobodyDeclaredThis"), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(VkShaders, FolderWithoutShadersIsRefused) {
    EXPECT_THROW(setShaderFolder("/nowhere at all"), Error);
    EXPECT_THROW(setShaderFolder(RELUME_SOURCE_DIR "/tests"), Error);
    EXPECT_THROW((void)shaderCode("no such shader"), Error);
    const TestShaders shaders;
    EXPECT_THROW((void)shaderCode("no such shader"), Error);
}

// The embedded shaders are what the sources say: both compilers build every program.
TEST(VkShaders, EveryProgramCompilesFromTheSourceFolder) {
    setShaderFolder(RELUME_SOURCE_DIR "/shaders");
    for (const std::string& name : shaderNames())
        EXPECT_GT(shaderCode(name).size(), 5u) << name;
    setShaderFolder("");
    for (const std::string& name : shaderNames())
        EXPECT_EQ(shaderCode(name).at(0), 0x07230203u) << name;
    EXPECT_GE(shaderNames().size(), 10u);
}

} // namespace relume
