#pragma once

#include <chrono>
#include <optional>

#include "app/offline/bake_options.h"
#include "app/offline/solve_watcher.h"
#include "assets/base/clock.h"
#include "assets/base/file_write.h"
#include "bake/output/checkpoint.h"

namespace relume {

/// Does what --checkpoint and --resume ask for; nothing if neither was given.
class BakeCheckpoints final : public SolveWatcher {
public:
    /// Reads the file of --resume and sees whether that of --checkpoint can be written. Throws Error. Every
    /// one of these ranks reads, the first one writes.
    explicit BakeCheckpoints(const BakeOptions& options, const Ranks& ranks = oneProcess());

    /// Goes on from --resume's file, before the first step. Throws Error when the file belongs to another
    /// bake.
    void begin(Baker& baker, const Scene& scene, const BakeSettings& settings, const vk::DeviceInfo& device);
    /// Saves when it is time to. A failure is a warning: the bake itself is sound.
    void afterStep(Solver& solver) override;
    bool due() const override { return !path_.empty() && Clock::now() >= next_; }
    bool saves() const override { return !path_.empty(); }
    /// Saves, and throws the Error that ends an interrupted bake.
    [[noreturn]] void interrupt(Solver& solver) override;

private:
    void save(Solver& solver, OnFailure onFailure);

    const Ranks& ranks_;
    std::string path_; // "": none is saved
    std::string shaders_;
    std::optional<Checkpoint> resumed_; // until begin()
    CheckpointKey key_;
    std::chrono::duration<double> every_;
    Clock::time_point next_;
};

} // namespace relume
