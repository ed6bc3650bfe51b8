#pragma once

#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/temporary_folder.h"
#include "tests/ui/viewer_process.h"
#include "tests/ui/virtual_display.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace relume {

inline const std::string kScenes = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/";
constexpr int kWidth = 1280, kHeight = 800;

/// A display of all tests, and a home of each.
class ViewerTest : public testing::Test {
protected:
    using Place = std::pair<int, int>;

    static void SetUpTestSuite() { display_ = std::make_unique<VirtualDisplay>(kWidth, kHeight); }
    static void TearDownTestSuite() { display_.reset(); }

    std::unique_ptr<ViewerProcess> open(std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"--log-actions", "--validate", "--size", "64"});
        const auto given = [&](const std::string& option) {
            return std::find(arguments.begin(), arguments.end(), option) != arguments.end();
        };
        // So that edits converge soon.
        if (!given("--error")) arguments.insert(arguments.end(), {"--error", "0.02"});
        if (!given("--method")) arguments.insert(arguments.end(), {"--local-error", "0.2"});
        auto viewer = std::make_unique<ViewerProcess>(
            ViewerProcess::Desc{.display = display_->name(), .home = home_.path(""), .arguments = arguments});
        EXPECT_TRUE(viewer->window()) << viewer->output();
        return viewer;
    }
    std::unique_ptr<ViewerProcess> openCornell() {
        auto viewer = open({"view", kScenes + "cornell_small.glb"});
        EXPECT_TRUE(viewer->says("bake: done", 240)) << viewer->output();
        viewer->keys({"bracketleft"}); // exposure by hand: automatic would follow what is to be compared
        return viewer;
    }

    /// Where a widget is, as the viewer told last.
    static std::optional<std::pair<int, int>> item(ViewerProcess& viewer, const std::string& name) {
        std::optional<std::pair<int, int>> place;
        const std::string text = viewer.output(), start = "item: " + name + " ";
        for (size_t at = text.find(start); at != std::string::npos; at = text.find(start, at + 1)) {
            int x = 0, y = 0;
            if (std::sscanf(text.c_str() + at + start.size(), "%d %d", &x, &y) == 2) place = {x, y};
        }
        return place;
    }

    /// Does something to a converged scene and waits until it has converged again.
    template<typename Do>
    static void edit(ViewerProcess& viewer, const std::string& name, Do what) {
        viewer.mark();
        what();
        EXPECT_TRUE(viewer.says(name)) << viewer.output();
        EXPECT_TRUE(viewer.shows("badge: converged", 240)) << viewer.output();
    }
    std::unique_ptr<ViewerProcess> openConverged() {
        auto viewer = openCornell();
        EXPECT_TRUE(viewer->shows("badge: converged", 60)) << viewer->output();
        return viewer;
    }
    static Place placeOf(ViewerProcess& viewer, const std::string& name) {
        const std::optional<Place> place = item(viewer, name);
        EXPECT_TRUE(place) << name << ": " << viewer.output();
        return place.value_or(Place{});
    }
    /// Takes a screenshot by its key and reads it.
    FloatImage screenshot(ViewerProcess& viewer, const std::string& key = "F12") {
        viewer.mark();
        viewer.keys({key});
        EXPECT_TRUE(viewer.says("wrote ")) << viewer.output();
        EXPECT_TRUE(viewer.says(".png")) << viewer.output();
        const std::string text = viewer.output();
        const size_t at = text.rfind("wrote ") + 6;
        return readImage(text.substr(at, text.find(".png", at) + 4 - at));
    }

    /// Quits by its key, without saving: a clean end within moments, and nothing that went wrong before.
    void quit(ViewerProcess& viewer) {
        viewer.mark();
        viewer.keys({"ctrl+q"});
        if (viewer.says("ask: ", 10)) viewer.keys({"d"}); // it does not wait where the viewer ends instead
        const std::optional<int> status = viewer.ended(10);
        ASSERT_TRUE(status) << "it does not end: " << viewer.output();
        EXPECT_EQ(*status, 0) << viewer.output();
        EXPECT_EQ(viewer.output().find("validation"), std::string::npos) << viewer.output();
    }

    static double mean(const FloatImage& image) {
        double sum = 0;
        for (size_t c = 0; c < 3; ++c)
            for (const float value : image.planes[c])
                sum += value;
        return sum / (3.0 * static_cast<double>(image.planes[0].size()));
    }
    static double difference(const FloatImage& a, const FloatImage& b) {
        if (a.width != b.width || a.height != b.height) return 1;
        double sum = 0;
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < a.planes[c].size(); ++i)
                sum += std::abs(a.planes[c][i] - b.planes[c][i]);
        return sum / (3.0 * static_cast<double>(a.planes[0].size()));
    }

    inline static std::unique_ptr<VirtualDisplay> display_;
    TemporaryFolder home_;
};

} // namespace relume
