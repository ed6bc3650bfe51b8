#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <thread>

#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

#include "app/bench/map_sink.h"
#include "app/live/live_bake.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/live/quick_bake.h"

namespace relume {

/// Stands for the drawing thread without OpenGL: it takes every map into memory.
class Screen : public MapSink {
public:
    using MapSink::MapSink;

    /// Returns the mean of all patches [cd/m^2].
    double mean() const {
        const std::span<const std::byte> bytes = texels();
        double sum = 0, count = 0;
        for (size_t i = 0; i < bytes.size(); i += sizeof(glm::u16vec4)) {
            glm::u16vec4 texel;
            std::memcpy(&texel, &bytes[i], sizeof(texel));
            const glm::vec4 value = glm::unpackHalf(texel);
            if (value.a < 0.75f) continue;
            sum += double{value.r} + value.g + value.b;
            count += 3;
        }
        return map()->unit * sum / count;
    }
};

/// A bake beside what stands for a drawing thread.
class LiveBakeTest : public testing::Test {
protected:
    ~LiveBakeTest() override { bake_.stop(); } // before the screen's memory goes, which it writes

    bool until(const std::function<bool()>& what, double seconds = kPatience) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (std::chrono::steady_clock::now() < end) {
            if (screen_.update() && onMap_) onMap_();
            if (what()) return true;
            if (isIn(BakeStatus::Phase::Failed)) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return false;
    }
    /// Tells by one look whether the newest bake is in the phase. Two looks would mix two bakes' statuses.
    bool isIn(BakeStatus::Phase phase) const {
        const BakeStatus status = bake_.status();
        return status.bake == newest_ && status.phase == phase;
    }
    bool untilPhase(BakeStatus::Phase phase) {
        return until([&] { return isIn(phase); });
    }
    /// Waits until the newest bake's end is on screen.
    bool untilShown() {
        return untilPhase(BakeStatus::Phase::Done) && until([&] {
                   return screen_.map() && screen_.map()->bake == newest_ && screen_.map()->complete;
               }) &&
               until([&, start = std::chrono::steady_clock::now()] {
                   return std::chrono::steady_clock::now() - start > std::chrono::milliseconds(50);
               });
    }
    void start(const BakeSettings& settings, bool keepLight = true) {
        newest_ =
            bake_.start({.scene = &scene_, .edits = edits_, .settings = settings, .keepLight = keepLight});
    }

    PreparedScene scene_ = cornell();
    SceneEdits edits_ = editsOf(scene_.scene);
    // This comes before there is a thread that makes a device, too, since Vulkan's function pointers are per
    // process.
    const bool software_ = testDevice().info().software();
    LiveBake bake_{{.validation = true}};
    Screen screen_{bake_.exchange()};
    std::function<void()> onMap_;
    uint64_t newest_ = 0;
};

} // namespace relume
