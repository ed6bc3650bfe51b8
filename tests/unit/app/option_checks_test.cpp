// This tests what options take: the checks by themselves, and that no option has others.
#include "app/commands/command_line.h"
#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

namespace relume {
namespace {

/// Returns the text as it comes out of a check, or "refused: ..." with what is told.
std::string passed(const CLI::Validator& check, std::string text) {
    const std::string problem = check(text);
    return problem.empty() ? text : "refused: " + problem;
}

bool passes(const CLI::Validator& check, const std::string& text) {
    return passed(check, text).rfind("refused: ", 0) != 0;
}

TEST(OptionChecks, ANumberIsFiniteAndWithinItsBounds) {
    for (const char* good : {"0", "1", "0.5", "5e-1", "+0.25", ".5", "1e-300"})
        EXPECT_TRUE(passes(numberFrom(0, 1), good)) << good;
    for (const char* bad :
         {"nan", "NaN", "-nan", "inf", "-inf", "infinity", "-1",  "1.0001", "1e30", "1e999", "",
          " ",   "x",   "1x",   "1 ",  " 1",   "0x1",      "1,0", "--1",    "+-1",  "++1"})
        EXPECT_FALSE(passes(numberFrom(0, 1), bad)) << bad;
    EXPECT_TRUE(passes(numberAbove(0, 1), "1"));
    EXPECT_FALSE(passes(numberAbove(0, 1), "0"));
    EXPECT_FALSE(passes(numberAbove(0, 1), "-0"));
    EXPECT_FALSE(passes(numberAbove(0, 1), "nan"));
}

TEST(OptionChecks, AWholeNumberIsDecimal) {
    EXPECT_EQ(passed(wholeFrom(8, 4096), "512"), "512");
    EXPECT_EQ(passed(wholeFrom(8, 4096), "010"), "10"); // CLI11 alone would read 8
    for (const char* bad : {"7", "4097", "-8", "+8", "8.0", "1e3", "0x10", "nan", "inf", "", "x", "8 ",
                            "99999999999999999999999"})
        EXPECT_FALSE(passes(wholeFrom(8, 4096), bad)) << bad;
}

TEST(OptionChecks, AWordIsOneOfThose) {
    EXPECT_TRUE(passes(oneOf({"1", "2", "4"}), "2"));
    for (const char* bad : {"3", "02", "", "2 ", "nan"})
        EXPECT_FALSE(passes(oneOf({"1", "2", "4"}), bad)) << bad;
    EXPECT_FALSE(passes(oneOf({"rmse"}), "RMSE"));
    EXPECT_EQ(passed(oneOfAnyCase({"rmse"}), "RMSE"), "rmse");
    EXPECT_TRUE(passes(powerOfTwo(2, 64), "64"));
    for (const char* bad : {"1", "3", "128", "-2"})
        EXPECT_FALSE(passes(powerOfTwo(2, 64), bad)) << bad;
}

TEST(OptionChecks, WhatIsAllowedIsTold) {
    EXPECT_EQ(passed(numberAbove(0, 1e6), "-1"),
              "refused: '-1' is not allowed: give a number above 0, at most 1000000");
    EXPECT_EQ(passed(numberFrom(1e-6, 1), "nan"),
              "refused: 'nan' is not allowed: give a number from 1e-06 to 1");
    EXPECT_EQ(passed(wholeFrom(8, 4096), ""),
              "refused: '' is not allowed: give a whole number from 8 to 4096");
    EXPECT_EQ(passed(oneOf({"1", "2", "4"}), "abc"), "refused: 'abc' is not allowed: choose 1, 2 or 4");
    EXPECT_EQ(passed(oneOf({"rtrad"}), "x"), "refused: 'x' is not allowed: choose rtrad");
    EXPECT_EQ(passed(existingFolder(), "/nowhere"),
              "refused: '/nowhere' is not allowed: name a folder that exists");
}

TEST(OptionChecks, ATypedNumberMayHaveAPlus) {
    EXPECT_EQ(typedNumber("+1.5"), 1.5f);
    EXPECT_EQ(typedNumber("+nan"), std::nullopt);
    EXPECT_EQ(typedNumbers("1,+2,-3", 3), (std::vector<float>{1, 2, -3}));
}

void eachOption(const CLI::App& app, const std::function<void(const CLI::App&, const CLI::Option&)>& visit) {
    for (const CLI::Option* option : app.get_options())
        visit(app, *option);
    for (const CLI::App* verb : app.get_subcommands({}))
        eachOption(*verb, visit);
}

TEST(OptionChecks, EveryNumberHasOneOfThem) {
    CLI::App app;
    addCommands(app);
    int numbers = 0;
    eachOption(app, [&](const CLI::App& verb, const CLI::Option& constOption) {
        CLI::Option& option = const_cast<CLI::Option&>(constOption); // as its accessors want it
        const std::string type = option.get_type_name();
        int checks = 0;
        try {
            for (;; ++checks)
                EXPECT_EQ(option.get_validator(checks)->get_name(), kOptionCheck)
                    << verb.get_name() << ' ' << option.get_name();
        } catch (const CLI::OptionNotFound&) { // there are no more
        }
        const bool isNumber =
            type.rfind("INT", 0) == 0 || type.rfind("UINT", 0) == 0 || type.rfind("FLOAT", 0) == 0;
        if (!isNumber) return;
        ++numbers;
        EXPECT_EQ(checks, 1) << verb.get_name() << ' ' << option.get_name() << ' ' << type;
    });
    EXPECT_GT(numbers, 60);
}

TEST(OptionChecks, NobodyUsesThoseOfTheParser) {
    namespace fs = std::filesystem;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(RELUME_SOURCE_DIR "/app")) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
        std::ifstream stream(entry.path());
        const std::string text{std::istreambuf_iterator<char>(stream), {}};
        for (const char* word :
             {"Range", "Bound", "Number", "PositiveNumber", "NonNegativeNumber", "IsMember", "Transformer",
              "CheckedTransformer", "TypeValidator", "ExistingDirectory", "ExistingFile"})
            EXPECT_EQ(text.find(std::string("CLI::") + word), std::string::npos)
                << entry.path() << ' ' << word;
    }
}

} // namespace
} // namespace relume
