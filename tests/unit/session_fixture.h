#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "app/live/session.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

namespace relume {

inline const std::string kScenes = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/";
constexpr uint32_t kSize = 64;

/// Holds a session of a scene file of its own. Bakes are counted, and none runs.
class SessionTest : public testing::Test {
protected:
    SessionTest() {
        std::filesystem::copy_file(kScenes + "cornell_small.glb", file(),
                                   std::filesystem::copy_options::overwrite_existing);
    }

    std::string file() const { return folder_.path("scene.glb"); }

    /// Runs frames until `what` is so. Counts the scenes that came.
    bool until(const std::function<bool()>& what, double seconds = 30) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (std::chrono::steady_clock::now() < end) {
            loads_ += session_.update();
            if (what()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return false;
    }
    bool untilLoaded() {
        return until([&] { return !session_.loading(); });
    }
    void open() {
        session_.open(file());
        ASSERT_TRUE(untilLoaded());
        ASSERT_NE(session_.scene(), nullptr);
    }
    /// Writes the scene file as an exporter does, with a newer time stamp.
    void writeFile(const std::string& from) {
        std::filesystem::copy_file(from, file(), std::filesystem::copy_options::overwrite_existing);
        std::filesystem::last_write_time(file(), time_ += std::chrono::seconds(2));
    }
    void dim(float factor, const std::string& name = "Emission") {
        Document next = session_.document();
        for (Material& material : next.edits.materials)
            material.emission *= factor;
        session_.edit(name, next);
    }
    float brightest() const {
        float most = 0;
        for (const Material& material : session_.document().edits.materials)
            most = std::max(most, material.emission.r);
        return most;
    }

    static BakeRequest request() {
        BakeRequest request;
        request.bake.size = kSize;
        return request;
    }

    const TemporaryFolder folder_;
    std::filesystem::file_time_type time_ = std::filesystem::file_time_type::clock::now();
    LiveBake bake_{{.device = "a device that nobody has"}};
    Session session_{bake_, request()};
    int loads_ = 0;
};

} // namespace relume
