#include "app/bench/methods_report.h"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/markup.h"

namespace relume {
namespace {

MethodRun made(const std::string& method, const std::string& setting, uint32_t size, double seconds) {
    MethodRun run;
    run.method = method;
    run.setting = setting;
    run.size = size;
    run.patches = size * size;
    run.passSeconds = seconds / 2;
    run.solveSeconds = seconds;
    run.totalSeconds = seconds + 0.1;
    run.rays = 1000000;
    run.dfpr = 0.01;
    run.relRmse = 0.02;
    run.localError = 0.07;
    run.flip = 0.03;
    return run;
}

MethodRun skipped(const std::string& method, uint32_t size, const std::string& note) {
    MethodRun run;
    run.method = method;
    run.size = size;
    run.note = note;
    return run;
}

MethodsReport report(std::vector<MethodRun> runs) {
    MethodsReport result;
    result.scene = "room.glb";
    result.device = "a device";
    result.driver = "a driver";
    result.command = "relume bench methods room.glb";
    result.passes = 2;
    result.reference = "a long bake";
    result.runs = std::move(runs);
    return result;
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(MethodsReport, IsOneWellFormedPageWithAllFigures) {
    MethodsReport r = report({made("pure", "", 64, 0.5), made("static", "window 2", 64, 0.125),
                              made("pure", "", 128, 8.0), made("static", "window 2", 128, 2.0)});
    r.runs[3].picture = std::string("\x89PNG\0", 5);
    r.runs[3].difference = "abcd";
    r.differenceScale = 0.2;
    const std::string html = methodsHtml(r);
    EXPECT_EQ(markupProblem(html), "");
    for (const char* part :
         {"a device", "a driver", "relume bench methods room.glb", "window 2", "250 ms", "8 s", "2 %", "7 %",
          "local error", "data:image/png;base64,iVBORwA=\"", "base64,YWJjZA==\"", "128² texels",
          "Error over time at 64²", "prefers-color-scheme: dark"})
        EXPECT_TRUE(has(html, part)) << part;
    // Nothing is loaded from elsewhere.
    for (const char* part : {"http:", "https:", "<script", "<link", "src=\"/"})
        EXPECT_FALSE(has(html, part)) << part;
}

TEST(MethodsReport, EscapesNames) {
    MethodsReport r = report({made("<b>&\"bold\"", "a<b & c", 64, 1)});
    r.scene = "</title><script>alert(1)</script>.glb";
    r.device = "Tom & Jerry's \"GPU\"";
    r.runs[0].note = "5 > 4 & 3 < 4";
    r.runs[0].picture = "x";
    const std::string html = methodsHtml(r);
    EXPECT_EQ(markupProblem(html), "");
    EXPECT_FALSE(has(html, "<script"));
    EXPECT_TRUE(has(html, "Tom &amp; Jerry&#39;s &quot;GPU&quot;"));
}

TEST(MethodsReport, HandlesOnePointZerosAndMissingValues) {
    MethodRun zero = made("static", "window 1", 64, 0.0);
    zero.relRmse = zero.flip = 0.0;
    MethodRun endless = made("hybrid", "16 samples", 64, 1.0);
    endless.relRmse = std::numeric_limits<double>::infinity();
    const std::vector<std::vector<MethodRun>> cases = {
        {},
        {made("pure", "", 64, 1)},
        {zero},
        {endless},
        {skipped("pure", 4096, "too many pairs")},
        {skipped("pure", 4096, "too many pairs"), zero, made("hybrid", "16 samples", 64, 0.1)}};
    for (const auto& runs : cases) {
        const std::string html = methodsHtml(report(runs));
        EXPECT_EQ(markupProblem(html), "");
        EXPECT_FALSE(has(html, "nan"));
        EXPECT_FALSE(has(html, ">inf"));
    }
    EXPECT_TRUE(has(methodsHtml(report(cases[4])), "too many pairs"));
    EXPECT_TRUE(has(methodsHtml(report({})), "Nothing was measured"));
}

TEST(MethodsReport, GivesTheSameFiguresAsJson) {
    MethodRun endless = made("hybrid", "16 samples", 64, 1.0);
    endless.relRmse = std::numeric_limits<double>::infinity();
    const auto parsed = methodsJson(report({made("pure", "", 64, 2), endless, skipped("static", 8, "no")}));
    EXPECT_EQ(parsed.at("passes"), 2);
    const auto& runs = parsed.at("runs");
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_EQ(runs[0].at("passSeconds"), 1.0);
    EXPECT_EQ(runs[0].at("rays"), 1000000);
    EXPECT_EQ(runs[0].at("localError"), 0.07);
    EXPECT_TRUE(runs[2].at("localError").is_null());
    EXPECT_FALSE(runs[0].contains("note"));
    EXPECT_TRUE(runs[1].at("relRMSE").is_null());
    EXPECT_TRUE(runs[2].at("rays").is_null());
    EXPECT_EQ(runs[2].at("note"), "no");
}

TEST(MethodsReport, PrintsRowsOfOneWidth) {
    const std::string row = methodsTableRow(made("montecarlo", "window 16", 1024, 12.5));
    EXPECT_EQ(row.size(), methodsTableHead().size());
    EXPECT_TRUE(has(row, "12.5 s"));
    EXPECT_TRUE(has(methodsTableRow(skipped("pure", 4096, "too many pairs")), "too many pairs"));
}

} // namespace
} // namespace relume
