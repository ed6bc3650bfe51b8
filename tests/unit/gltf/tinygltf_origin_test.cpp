#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <dlfcn.h>

#include <string>

namespace relume {
namespace {

// libdraco exports a TinyGLTF of its own, whose classes have another layout: with its functions the program
// would damage its memory.
TEST(TinyGltf, ItsFunctionsComeFromTheLibraryOfItsHeader) {
    const auto function = static_cast<bool (*)(tinygltf::Image*, int, std::string*, std::string*, int, int,
                                               const unsigned char*, int, void*)>(&tinygltf::LoadImageData);
    Dl_info info{};
    ASSERT_NE(dladdr(reinterpret_cast<void*>(function), &info), 0);
    EXPECT_NE(std::string(info.dli_fname).find("tinygltf"), std::string::npos) << info.dli_fname;
}

} // namespace
} // namespace relume
