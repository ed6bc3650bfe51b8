#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include <dlfcn.h>

// The validation layer leaks a little of its own; under LeakSanitizer only that is forgiven.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libVkLayer_khronos_validation";
}

namespace relume {

namespace {

std::unique_ptr<vk::Device>& device() {
    static std::unique_ptr<vk::Device> instance;
    return instance;
}

// Makes the device for the first test that asks, so that listing the tests needs none, and destroys it while
// validation still listens.
class DeviceLifetime final : public testing::Environment {
public:
    void TearDown() override {
        device().reset();
        EXPECT_EQ(vk::Device::validationMessagesOfAll(), seen_)
            << "validation complained as the device was destroyed";
    }
    static inline uint32_t seen_ = 0;
};

class ValidationListener final : public testing::EmptyTestEventListener {
    void OnTestStart(const testing::TestInfo&) override {
        DeviceLifetime::seen_ = vk::Device::validationMessagesOfAll();
    }
    void OnTestEnd(const testing::TestInfo&) override {
        const uint32_t now = vk::Device::validationMessagesOfAll();
        EXPECT_EQ(now, DeviceLifetime::seen_) << "Vulkan validation messages, see the log above";
        DeviceLifetime::seen_ = now;
    }
};

// gtest_main has no place to register things; it takes what is there before it starts.
[[maybe_unused]] const bool gpuRegistered = [] {
    testing::AddGlobalTestEnvironment(new DeviceLifetime);
    testing::UnitTest::GetInstance()->listeners().Append(new ValidationListener);
    return true;
}();

} // namespace

const vk::Device& testDevice() {
    if (!device()) {
        const char* select = std::getenv("RELUME_TEST_DEVICE");
        device() = std::make_unique<vk::Device>(
            vk::Device::Desc{.select = select != nullptr ? select : "", .validation = true});
        // The layer stays loaded to the end, or the leaks above would have no name any more.
        (void)dlopen("libVkLayer_khronos_validation.so", RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
    }
    return *device();
}

} // namespace relume
