#include "assets/base/json_text.h"

#include <gtest/gtest.h>

#include <functional>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the text after an edit; its value must be that of the edited JSON.
std::string edited(const std::string& text, const std::function<void(Json&)>& edit) {
    const Json before = Json::parse(text);
    Json after = before;
    edit(after);
    std::string out = patchJsonText(text, before, after);
    EXPECT_EQ(nlohmann::json::parse(out), nlohmann::json::parse(after.dump())) << out;
    return out;
}

TEST(JsonText, WhatStaysKeepsItsSpelling) {
    const std::string text =
        " {\"a\" : 1.50e+1,\"big\":18446744073709551617, \"s\":\"\\u0041\\/\\\"]\",\n\"b\":[ 1.0 ,2,3 ] }\n";
    EXPECT_EQ(edited(text, [](Json&) {}), text);
    EXPECT_EQ(edited(text, [](Json& root) { root["b"][1] = 0.25; }),
              " {\"a\" : 1.50e+1,\"big\":18446744073709551617, \"s\":\"\\u0041\\/\\\"]\",\n\"b\":[ 1.0 "
              ",0.25,3 ] }\n");
}

TEST(JsonText, MembersAreAddedAndRemovedInTheLayoutOfTheFile) {
    const std::string lines = "{\n    \"a\": {\n        \"x\": 1\n    },\n    \"b\": [1, 2]\n}";
    EXPECT_EQ(
        edited(lines,
               [](Json& root) {
                   root["a"]["y"] = {{"z", {3, 4}}};
               }),
        "{\n    \"a\": {\n        \"x\": 1,\n        \"y\": {\n            \"z\": [\n                3,\n"
        "                4\n            ]\n        }\n    },\n    \"b\": [1, 2]\n}");
    EXPECT_EQ(edited(lines, [](Json& root) { root["b"].push_back(3); }),
              "{\n    \"a\": {\n        \"x\": 1\n    },\n    \"b\": [1, 2, 3]\n}");
    EXPECT_EQ(edited(lines, [](Json& root) { root.erase("a"); }), "{\n    \"b\": [1, 2]\n}");
    EXPECT_EQ(edited(lines, [](Json& root) { root.erase("b"); }),
              "{\n    \"a\": {\n        \"x\": 1\n    }\n}");
    EXPECT_EQ(edited("{\"a\":1,\"b\":2}",
                     [](Json& root) {
                         root["c"] = {{"d", true}};
                     }),
              "{\"a\":1,\"b\":2,\"c\":{\"d\":true}}");
}

TEST(JsonText, WhatIsEmptyIsFilledAndEmptied) {
    EXPECT_EQ(edited("{\"a\":{},\"b\":[]}",
                     [](Json& root) {
                         root["a"]["x"] = 1;
                         root["b"].push_back(2);
                     }),
              "{\"a\":{\"x\":1},\"b\":[2]}");
    EXPECT_EQ(edited("{\"a\": {\"x\": 1}, \"b\": [2]}",
                     [](Json& root) {
                         root["a"].erase("x");
                         root["b"].erase(0);
                     }),
              "{\"a\": {}, \"b\": []}");
    EXPECT_EQ(edited("{}", [](Json& root) { root["a"] = 1; }), "{\"a\":1}");
}

TEST(JsonText, ElementsAreRemovedFromTheMiddle) {
    EXPECT_EQ(edited("[{\"a\": 1}, {\"b\": 2}, {\"c\": 3}]", [](Json& root) { root.erase(1); }),
              "[{\"a\": 1}, {\"c\": 3}]");
}

TEST(JsonText, AKeyThatStandsTwiceIsNoTrap) {
    EXPECT_EQ(edited("{\"a\": {\"x\": [1], \"x\": 2, \"y\": 3}, \"b\": 1.0}",
                     [](Json& root) { root["a"]["y"] = 4; }),
              "{\"a\": {\"x\":2,\"y\":4}, \"b\": 1.0}");
}

TEST(JsonText, BracketsInStringsAreText) {
    EXPECT_EQ(
        edited("{\"a]}\\\\\": \"{[\\\"\", \"b\": {\"c\": \"}\"}}", [](Json& root) { root["b"]["c"] = "]"; }),
        "{\"a]}\\\\\": \"{[\\\"\", \"b\": {\"c\": \"]\"}}");
}

TEST(JsonText, ANameThatIsNoUtf8IsWrittenAllTheSame) {
    const Json before = Json::parse("{\"a\":1}");
    Json after = before;
    after["a"] = "\xff";
    EXPECT_TRUE(Json::accept(patchJsonText("{\"a\":1}", before, after)));
}

} // namespace
} // namespace relume
