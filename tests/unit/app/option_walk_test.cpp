// Every option of every verb gets values that are absurd: each is refused as wrong usage in a message that
// names the option, or does what the tables below say. Nothing is done, as no file is there that a verb
// begins with.
#include "app/commands/command_line.h"
#include "assets/base/error.h"
#include "tests/temporary_folder.h"

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace relume {
namespace {

using WalkWords = std::vector<std::string>;
using OptionNames = std::set<std::string>;

const WalkWords kValues = {"-1", "0", "nan", "inf", "1e30", "", "x"};

/// Each verb is given these beside the option, so that it gets as far as its first file, which is missing.
const std::map<std::string, WalkWords> kVerbs = {
    {"view", {"missing.glb"}},
    {"bake", {"missing.glb", "-o", "out.exr"}},
    {"shot", {"missing.glb", "-o", "out.png"}},
    {"timelapse", {"missing.glb", "-o", "frames"}},
    {"edit", {"missing.glb", "-o", "out.glb", "--delete", "Lamp", "--bake", "out.exr"}},
    {"info", {"missing.glb"}},
    {"unwrap", {"missing.glb", "-o", "out.glb"}},
    {"import", {"missing.obj", "-o", "out.glb"}},
    {"scene", {"nosuchscene", "-o", "out.glb"}},
    {"devices", {}},
    {"mix", {"missing.exr", "-o", "out.exr"}},
    {"compare", {"missing.exr", "missing.exr"}},
    {"samples", {"4", "-o", "missing/out.csv"}},
    {"export", {"missing.glb", "-o", "folder", "--for", "three"}},
    {"bench trace", {"missing.glb"}},
    {"bench frames", {"missing.glb"}},
    {"bench quality", {"missing.glb"}},
    {"bench edits", {"missing.glb"}},
    {"bench reload", {"missing.glb"}},
    {"bench methods", {"missing.glb", "--html", "out.html"}},
};

/// These options are refused without another one.
const std::map<std::string, WalkWords> kWith = {
    {"--checkpoint-every", {"--checkpoint", "out.checkpoint"}},
    {"--layer-memory", {"--layers"}}, // and the next one: of bake
    {"--lights", {"--layers"}},
    {"--distance-factor", {"--preset", "rtrad"}},
    {"--window", {"--method", "static"}},
    {"--node", {"--method", "adaptive"}},
    {"--threshold", {"--method", "adaptive"}},
    {"--threshold-ramp", {"--method", "adaptive"}},
    {"--voxels", {"--tracer", "voxel"}},
    {"--probes", {"--probes-out", "probes.json"}},
    {"--probe-at", {"--probes-out", "probes.json"}},
    {"--probe-samples", {"--probes", "1", "--probes-out", "probes.json"}},
    {"--eye", {"--target", "1,2,3"}},
    {"--target", {"--eye", "1,2,3"}},
};

/// These options take a text of any kind: names, and files that may be called so. What they mean by it
/// decides whether it is a mistake.
const OptionNames kTexts = {
    "--scene",    "--variant", "in",           "SCENE",       "name",          "a",        "b",
    "layers",     "--output",  "--picture",    "--json",      "--html",        "--plot",   "--diff",
    "--mask",     "--dark-by", "--error-map",  "--scene-out", "--camera",      "--device", "--bake-device",
    "--resume",   "--bake",    "--checkpoint", "--lightmap",  "--write-scene", "--set",    "--move",
    "--rotate",   "--aim",     "--add",        "--duplicate", "--delete",      "--hide",   "--show",
    "--mute",     "--solo",    "--pictures",   "--plot-rays", "--reference",   "--layers", "--probes-out",
    "--probes-in"};

/// These are options of other verbs, too, where they take numbers or need no other option.
const OptionNames kOfBake = {"--layer-memory", "--lights", "--probes"};

/// Tells whether an option takes any text. Some do in one verb alone, and take numbers elsewhere.
bool takesText(const std::string& name, const std::string& verb) {
    return kTexts.contains(name) || (name == "--lights" && verb == "bake") ||
           (name == "--probes" && verb == "export");
}

/// For all other options, these are the values among the absurd ones that mean something.
const std::map<std::string, WalkWords> kMeanings = {
    {"--voxel-ratio", {"0"}},     // no voxels
    {"--dilate", {"0"}},          // no rings
    {"--reflectivity", {"0"}},    // black surfaces
    {"--distance-factor", {"0"}}, // of RTRad: distances do not count
    {"--threshold", {"0"}},       // nothing is merged
    {"--thresholds", {"0"}},
    {"--rate", {"0"}}, // as many frames as there can be
    {"--msaa", {"0"}}, // one sample
    {"--seed", {"0"}},
    {"--changes", {"0"}},        // of bench reload: none at random
    {"--local-error", {"0"}},    // any will do
    {"--time", {"0"}},           // where the animation begins
    {"--up", {"x"}},             // an axis
    {"--exposure", {"-1", "0"}}, // [EV]
    // An empty text is as good as none.
    {"--cache-memory", {""}},
    {"--layer-memory", {""}},
    {"--at", {""}},
    {"--window-size", {""}},
};

enum class WalkEnd { Refused, World, Done };

struct WalkOutcome {
    WalkEnd end = WalkEnd::Done;
    std::string message;
};

/// Runs a command line as main does. Other exceptions are mistakes of the program and go through.
WalkOutcome walkOutcome(const WalkWords& typed) {
    CLI::App app;
    app.name("relume");
    app.require_subcommand(1);
    addCommands(app);
    try {
        WalkWords arguments = parserArguments(typed, app);
        std::reverse(arguments.begin(), arguments.end());
        app.parse(std::move(arguments));
    } catch (const CLI::ParseError& error) {
        return {WalkEnd::Refused, error.what()};
    } catch (const UsageError& error) {
        return {WalkEnd::Refused, error.what()};
    } catch (const Error& error) {
        return {WalkEnd::World, error.what()};
    }
    return {};
}

class OptionWalk : public testing::TestWithParam<std::string> {
protected:
    OptionWalk() : before_(std::filesystem::current_path()) {
        std::filesystem::current_path(folder_.path());
        for (const char* display :
             {"DISPLAY", "WAYLAND_DISPLAY"}) // else the viewer opens before it misses a scene
            unsetenv(display);
    }
    ~OptionWalk() override { std::filesystem::current_path(before_); }

    static WalkWords verbOf(const std::string& verb) {
        const size_t blank = verb.find(' ');
        if (blank == std::string::npos) return {verb};
        return {verb.substr(0, blank), verb.substr(blank + 1)};
    }

    /// Returns the line that gives the option this value, in place of what the verb's own line gives it.
    static WalkWords lineWith(const std::string& verb, const CLI::Option& option, const std::string& value) {
        WalkWords words = verbOf(verb), own = kVerbs.at(verb);
        const std::string name = option.get_name();
        if (option.get_positional()) {
            const size_t place = name == "b" ? 1 : 0;
            if (place < own.size() && !own[place].starts_with('-'))
                own[place] = value;
            else
                own.insert(own.begin(), value);
        }
        for (size_t i = 0; i < own.size(); ++i) {
            const std::string typed = own[i] == "-o" ? "--output" : own[i];
            if (typed == name)
                own.erase(own.begin() + std::ptrdiff_t(i), own.begin() + std::ptrdiff_t(i) + 2);
        }
        words.insert(words.end(), own.begin(), own.end());
        if (const auto with = kWith.find(name);
            with != kWith.end() && (!kOfBake.contains(name) || verb == "bake"))
            words.insert(words.end(), with->second.begin(), with->second.end());
        if (!option.get_positional()) words.insert(words.end(), {name, value});
        return words;
    }

    const TemporaryFolder folder_;

private:
    std::filesystem::path before_;
};

std::string typedLine(const WalkWords& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : " ") + (word.empty() ? "''" : word);
    return text;
}

const CLI::App& verbIn(const CLI::App& app, const std::string& verb) {
    const size_t blank = verb.find(' ');
    const CLI::App& first = *app.get_subcommand(verb.substr(0, blank));
    return blank == std::string::npos ? first : *first.get_subcommand(verb.substr(blank + 1));
}

TEST_P(OptionWalk, AbsurdValuesAreRefused) {
    CLI::App app;
    addCommands(app);
    const CLI::App& verb = verbIn(app, GetParam());
    int options = 0;
    for (const CLI::Option* option : verb.get_options()) {
        const std::string name = option->get_name();
        if (name == "--help") continue;
        ++options;
        const bool isFlag = option->get_items_expected_max() == 0;
        for (const std::string& value : kValues) {
            WalkWords line = lineWith(GetParam(), *option, value);
            if (isFlag && value.empty()) continue;
            if (isFlag) {
                line.pop_back();
                line.back() += "=" + value;
            }
            SCOPED_TRACE(typedLine(line));
            const WalkOutcome outcome = walkOutcome(line);
            EXPECT_EQ(outcome.message.find('\n'), std::string::npos) << outcome.message;
            if (!isFlag && takesText(name, GetParam())) {
                EXPECT_TRUE(value.empty() || outcome.end != WalkEnd::Done); // empty is as good as none
                continue;
            }
            const auto meanings = kMeanings.find(name);
            const bool means =
                !isFlag && meanings != kMeanings.end() &&
                std::find(meanings->second.begin(), meanings->second.end(), value) != meanings->second.end();
            EXPECT_EQ(outcome.end, means ? WalkEnd::World : WalkEnd::Refused) << outcome.message;
            EXPECT_TRUE(means || outcome.message.find(name) != std::string::npos) << outcome.message;
        }
    }
    EXPECT_GT(options, 0);
    EXPECT_EQ(folder_.files(), WalkWords()) << "something was written";
}

std::vector<std::string> walkedVerbs() {
    std::vector<std::string> verbs;
    for (const auto& [verb, line] : kVerbs)
        verbs.push_back(verb);
    return verbs;
}

INSTANTIATE_TEST_SUITE_P(Verbs, OptionWalk, testing::ValuesIn(walkedVerbs()), [](const auto& test) {
    std::string name = test.param;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

TEST(OptionWalkVerbs, NoneIsLeftOut) {
    CLI::App app;
    addCommands(app);
    WalkWords verbs;
    for (const CLI::App* verb : app.get_subcommands({})) {
        const auto below = verb->get_subcommands({});
        for (const CLI::App* second : below)
            verbs.push_back(verb->get_name() + " " + second->get_name());
        if (below.empty()) verbs.push_back(verb->get_name());
    }
    std::sort(verbs.begin(), verbs.end());
    EXPECT_EQ(verbs, walkedVerbs());
}

} // namespace
} // namespace relume
