#include "app/commands/command_line.h"
#include "assets/base/error.h"

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace relume {
namespace {

using CommandWords = std::vector<std::string>;

class CommandLine : public testing::Test {
protected:
    CommandLine() {
        app_.name("relume");
        app_.require_subcommand(1);
        addCommands(app_);
    }

    CommandWords ready(const CommandWords& typed) const { return parserArguments(typed, app_); }
    std::string refusalOf(const CommandWords& typed) const {
        try {
            ready(typed);
        } catch (const UsageError& error) {
            return error.what();
        }
        return "accepted";
    }
    /// Returns what the parser tells on the standard error.
    std::string told(const CommandWords& typed) {
        CommandWords arguments = ready(typed);
        std::reverse(arguments.begin(), arguments.end());
        std::ostringstream out, error;
        try {
            app_.parse(std::move(arguments));
        } catch (const CLI::ParseError& problem) {
            app_.exit(problem, out, error);
        }
        return error.str();
    }

    CLI::App app_;
};

TEST_F(CommandLine, AnEmptyValueIsAWordOfItsOwn) {
    EXPECT_EQ(ready({"bake", "r.glb", "--size=", "-o", "o.exr"}),
              (CommandWords{"bake", "r.glb", "--size", "", "-o", "o.exr"}));
    EXPECT_EQ(ready({"bake", "r.glb", "--size=8"}), (CommandWords{"bake", "r.glb", "--size=8"}));
    EXPECT_EQ(ready({"bench", "frames", "r.glb", "--msaa="}),
              (CommandWords{"bench", "frames", "r.glb", "--msaa", ""}));
    EXPECT_EQ(ready({"bake", "--", "--size="}), (CommandWords{"bake", "--", "--size="}));
    EXPECT_EQ(ready({"edit", "r.glb", "--set", "a.name="}),
              (CommandWords{"edit", "r.glb", "--set", "a.name="}));
    EXPECT_EQ(ready({"room.glb", "--size="}), (CommandWords{"view", "room.glb", "--size", ""}));
}

TEST_F(CommandLine, AFlagTakesNoValue) {
    EXPECT_EQ(refusalOf({"bake", "r.glb", "--half=nan"}),
              "'--half=nan': --half takes no value: leave out '=nan'");
    EXPECT_EQ(refusalOf({"--quiet=0", "bake"}), "accepted"); // of main, not added here
    EXPECT_EQ(refusalOf({"bench", "edits", "r.glb", "--all-lights=-1"}),
              "'--all-lights=-1': --all-lights takes no value: leave out '=-1'");
    EXPECT_EQ(refusalOf({"bake", "r.glb", "--half"}), "accepted");
}

TEST_F(CommandLine, AnUnknownVerbIsNamed) {
    EXPECT_EQ(refusalOf({"bakee", "r.glb"}),
              "'bakee' is no verb and no scene (.glb, .gltf, .obj, .fbx, ...): did you mean 'bake'?");
    EXPECT_NE(refusalOf({"-q", "nosuchverb"}).find("there is 'view', 'bake'"), std::string::npos);
    EXPECT_EQ(refusalOf({"--version"}), "accepted");
    EXPECT_EQ(refusalOf({"missing.glb"}), "accepted");
}

TEST_F(CommandLine, WhatTheParserTellsIsOneLine) {
    EXPECT_EQ(told({"bake", "r.glb", "-o", "o.exr", "--density", "-1"}),
              "error: --density: '-1' is not allowed: give a number above 0, at most 1000000\n");
    EXPECT_EQ(told({"bake", "r.glb", "--size="}),
              "error: --size: '' is not allowed: give a whole number from 8 to 8192\n");
    EXPECT_EQ(told({"bench", "frames", "r.glb", "--display", "x"}),
              "error: --display: 'x' is not allowed: choose auto, shared or copied\n");
    EXPECT_EQ(told({"bench", "frames"}),
              "error: SCENE is required: 'relume bench frames --help' shows what there is\n");
    EXPECT_EQ(told({}), "error: A subcommand is required: 'relume --help' shows what there is\n");
}

TEST_F(CommandLine, WhatHelpsWithoutMemoryGoesByTheVerb) {
    const auto adviceFor = [](const CommandWords& typed) {
        CLI::App app;
        app.name("relume");
        addCommands(app);
        CommandWords arguments(typed.rbegin(), typed.rend());
        try {
            app.parse(std::move(arguments));
        } catch (const CLI::ParseError&) { // as not all that it wants is there
        }
        return outOfMemoryMessage(app);
    };
    EXPECT_EQ(adviceFor({"bake"}),
              "out of memory: use a smaller --size or a smaller scene, or close other programs");
    EXPECT_EQ(adviceFor({"shot"}),
              "out of memory: use a smaller --lightmap-size or a smaller scene, or close other programs");
    EXPECT_EQ(adviceFor({"bench", "trace"}),
              "out of memory: use a smaller --sizes or a smaller scene, or close other programs");
    EXPECT_EQ(adviceFor({"compare"}), "out of memory: use smaller files or close other programs");
    EXPECT_EQ(adviceFor({"mix"}), "out of memory: use smaller files or close other programs");
}

} // namespace
} // namespace relume
