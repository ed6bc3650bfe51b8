#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "bake/solver/solver.h"

namespace relume::test {

/// Has a state and no light.
class ParkedSolver final : public Solver {
public:
    struct Own {
        uint32_t samplePass = 0, chunk = 0;
    };
    Own own;
    std::vector<std::vector<uint8_t>> parts;
    uint32_t restores = 0;

    explicit ParkedSolver(std::vector<size_t> sizes) {
        for (size_t size : sizes)
            parts.emplace_back(size);
    }
    void fill() {
        own = {7, 42};
        progress_.passes = 3;
        progress_.rays = 1'234'567'890'123ull;
        progress_.cacheBytes = 99; // this process' own
        progress_.passSeconds = {0.5, 0.25, 0.125};
        uint32_t value = 1;
        for (std::vector<uint8_t>& part : parts) {
            for (uint8_t& byte : part)
                byte = static_cast<uint8_t>((value = 1664525u * value + 1013904223u) >> 24);
        }
    }
    void step() override {}
    void setPriority(std::vector<uint8_t>) override {}
    bool passBoundary() const override { return true; }
    void abortPass() override {}
    LiveLight liveLight() override { return {}; }
    const std::vector<glm::vec4>& light() override { return light_; }
    std::vector<float> errors() override { return {}; }
    SolverState state() override { return makeState(own); }
    std::vector<StatePart> stateParts() override {
        std::vector<StatePart> result;
        for (std::vector<uint8_t>& part : parts) {
            result.push_back({part.size(),
                              [&part](void* to, uint64_t offset, uint64_t size) {
                                  std::memcpy(to, part.data() + offset, size);
                              },
                              [&part](const void* from, uint64_t offset, uint64_t size) {
                                  std::memcpy(part.data() + offset, from, size);
                              }});
        }
        return result;
    }
    void restore(const SolverState& state) override {
        own = takeState<Own>(state);
        ++restores;
    }

private:
    std::vector<glm::vec4> light_;
};

} // namespace relume::test
