// Which of a machine's devices is taken.
#include "assets/base/error.h"
#include "bake/vk/device.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

vk::DeviceInfo deviceNamed(uint32_t index, const char* name, VkPhysicalDeviceType type) {
    vk::DeviceInfo info;
    info.index = index;
    info.name = name;
    info.type = type;
    return info;
}

std::vector<vk::DeviceInfo> machine() {
    return {deviceNamed(0, "llvmpipe", VK_PHYSICAL_DEVICE_TYPE_CPU),
            deviceNamed(1, "Card A", VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU),
            deviceNamed(2, "Board", VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU),
            deviceNamed(3, "Card B", VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU)};
}

TEST(DeviceChoice, processesOfAMachineTakeTheBestDevicesInTurn) {
    const std::vector<vk::DeviceInfo> infos = machine();
    for (uint32_t turn = 0; turn < 6; ++turn)
        EXPECT_EQ(vk::chooseDevice(infos, "", turn).index, turn % 2 == 0 ? 1u : 3u);
}

TEST(DeviceChoice, ANamedDeviceIsTakenByAll) {
    const std::vector<vk::DeviceInfo> infos = machine();
    for (uint32_t turn = 0; turn < 3; ++turn) {
        EXPECT_EQ(vk::chooseDevice(infos, "2", turn).index, 2u);
        EXPECT_EQ(vk::chooseDevice(infos, "llvm", turn).index, 0u);
    }
    EXPECT_EQ(vk::chooseDevice(infos, "card", 1).index, 3u); // two have it in their names
}

TEST(DeviceChoice, ASecondGpuIsNoneOfThoseThatHaveOtherWork) {
    std::vector<vk::DeviceInfo> infos = machine();
    for (vk::DeviceInfo& info : infos)
        info.uuid[0] = static_cast<uint8_t>(info.index + 1);
    std::vector<vk::DeviceUuid> drawing = {infos[1].uuid};
    EXPECT_EQ(vk::chooseDevice(infos, "", 0, drawing).index, 3u);
    drawing.push_back(infos[3].uuid);
    EXPECT_EQ(vk::chooseDevice(infos, "", 0, drawing).index, 2u);
    drawing.push_back(infos[2].uuid);
    EXPECT_THROW(static_cast<void>(vk::chooseDevice(infos, "", 0, drawing)), Error)
        << "none but the CPU is left";
}

TEST(DeviceChoice, OneThatLacksSomethingIsTakenLastAndRefused) {
    std::vector<vk::DeviceInfo> infos = machine();
    infos[1].missing = {"shaderInt64"};
    EXPECT_EQ(vk::chooseDevice(infos, "", 1).index, 3u);
    EXPECT_THROW(static_cast<void>(vk::chooseDevice(infos, "1", 0)), Error);
    EXPECT_THROW(static_cast<void>(vk::chooseDevice(infos, "nothing", 0)), Error);
    EXPECT_THROW(static_cast<void>(vk::chooseDevice({}, "", 0)), Error);
}

} // namespace
} // namespace relume
