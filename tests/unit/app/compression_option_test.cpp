#include "app/offline/compression_option.h"

#include "assets/base/error.h"

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include <set>

namespace relume {
namespace {

TEST(CompressionOption, EachNameIsAnotherCompression) {
    std::set<ExrCompression> all;
    for (const char* name : {"none", "rle", "zips", "zip", "piz"}) {
        CLI::App app;
        std::string typed;
        addCompressionOption(app, typed);
        app.parse(std::string("--compression ") + name);
        EXPECT_EQ(typed, name);
        all.insert(compressionOf(typed));
    }
    EXPECT_EQ(all.size(), 5u);
    EXPECT_EQ(compressionOf("none"), ExrCompression::Off);
    EXPECT_EQ(compressionOf("piz"), ExrCompression::Piz);
    EXPECT_EQ(compressionOf(""), kExrCompression);
}

TEST(CompressionOption, WaysThatLoseBitsAreRefused) {
    for (const char* name : {"pxr24", "b44", "b44a", "dwaa", "dwab", "ZIP"}) {
        CLI::App app;
        std::string typed;
        addCompressionOption(app, typed);
        EXPECT_THROW(app.parse(std::string("--compression ") + name), CLI::ValidationError) << name;
    }
}

TEST(CompressionOption, MakesNoSenseWithoutAnOpenExrFile) {
    EXPECT_NO_THROW(checkCompression("", {"a.png"}));
    EXPECT_NO_THROW(checkCompression("zip", {"a.exr"}));
    EXPECT_NO_THROW(checkCompression("zip", {"a.EXR", ""}));
    EXPECT_NO_THROW(checkCompression("zip", {"a.png", "error.exr"}));
    EXPECT_THROW(checkCompression("zip", {"a.png", ""}), UsageError);
    EXPECT_THROW(checkCompression("none", {"exr"}), UsageError);
    EXPECT_THROW(checkCompression("none", {}), UsageError);
}

} // namespace
} // namespace relume
