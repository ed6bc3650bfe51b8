#include "assets/base/uri.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace relume {
namespace {

TEST(Uri, KnowsUtf8) {
    for (const char* text :
         {"", "plain", "h\xc3\xa4user", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xf4\x8f\xbf\xbf"})
        EXPECT_TRUE(isUtf8(text)) << text;
    for (const char* text : {"\xe9", "a\xe9z", "\xc3", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80",
                             "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80", "\x80", "\xe2\x82"})
        EXPECT_FALSE(isUtf8(text)) << text;
}

TEST(Uri, ComesBackAsItWas) {
    for (const std::string path : {"a b/c%20d.bin", "h\xc3\xa4user/x", "caf\xe9/\xff.png", "100%"}) {
        EXPECT_EQ(decodedUri(encodedUri(path)), path);
        EXPECT_TRUE(isUtf8(encodedUri(path)));
    }
    EXPECT_EQ(encodedUri("h\xc3\xa4user"), "h\xc3\xa4user");
    EXPECT_EQ(encodedUri("caf\xe9"), "caf%E9");
}

TEST(Uri, TellsWhatIsRelative) {
    for (const char* uri : {"a.bin", "sub/a:b.bin", "./x"})
        EXPECT_TRUE(isRelativeUri(uri)) << uri;
    for (const char* uri : {"", "/a", "#a", "data:x", "https://x"})
        EXPECT_FALSE(isRelativeUri(uri)) << uri;
}

// The examples are those of RFC 4648, section 10.
TEST(Uri, HoldsItsOwnBytes) {
    const auto text = [](const std::string& base64) {
        const auto bytes = bytesOfDataUri("data:image/png;base64," + base64);
        return bytes ? std::string(bytes->begin(), bytes->end()) : "none";
    };
    for (const auto& [base64, plain] :
         std::vector<std::pair<std::string, std::string>>{{"", ""},
                                                          {"Zg==", "f"},
                                                          {"Zm8=", "fo"},
                                                          {"Zm9v", "foo"},
                                                          {"Zm9vYg==", "foob"},
                                                          {"Zm9vYmE=", "fooba"},
                                                          {"Zm9vYmFy", "foobar"}}) {
        EXPECT_EQ(text(base64), plain);
        EXPECT_EQ(dataUriOf(plain), "data:application/octet-stream;base64," + base64);
    }
    EXPECT_EQ(dataUriOf("\xfb\xff\xbf"), "data:application/octet-stream;base64,+/+/");
    EXPECT_EQ(text("+/+/"), "\xfb\xff\xbf");
    EXPECT_EQ(text("Zm9v!Zm9v"), "foo") << "up to what is no base64";
    for (const char* other : {"a.png", "data:,x", "data:text/plain,Zm9v", "data:image/png;base64"})
        EXPECT_FALSE(bytesOfDataUri(other)) << other;
}

} // namespace
} // namespace relume
