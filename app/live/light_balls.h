#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/live/lit_ball.h"
#include "assets/base/clock.h"
#include "bake/baker/baker.h"
#include "bake/probes/probe_light.h"
#include "renderer/box.h"

namespace relume {

/// Holds what is known about the balls that a viewer looks at.
struct BallFacts {
    bool wanted = false;     // there are any
    bool traced = false;     // their links are of the places, triangles and analytic lights as these are now
    bool newer = false;      // the light has changed since the last answer
    double secondsSince = 0; // the last answer
};
enum class BallStep { None, Wait, Gather, Trace };
/// Decides what comes next. New places are traced at once; new light waits, so that no bake is held up by it.
BallStep decideBalls(const BallFacts& facts);

/// Says what stands against the light of places.
struct BallMeans {
    bool rtrad = false; // the bake follows RTRad, whose radiosity is no light that comes to a place
    uint64_t needed = 0, free = 0; // device memory [bytes]
};
/// Returns why there can be no light of places, and what helps, in one line; "" where there can be.
std::string ballProblem(const BallMeans& means);

/// Returns where light probes of a view stand: a grid in these bounds [m] of a few hundred at most. Empty
/// bounds have none.
std::vector<glm::vec3> gridOfView(const Box& bounds);

/// Finds the light at places that a viewer looks at, while a bake goes on: by links of their own, so that new
/// light costs no ray. Only the bake thread uses it.
class LightBalls {
public:
    /// The ledger counts what balls take on the device as this owner's (vk::MemoryOwner), which is
    /// ProbeTracer's.
    static constexpr const char* kOwner = "probes";
    explicit LightBalls(const vk::Device& device) : device_(device) {}

    /// Replaces what was asked for before.
    void ask(BallRequest request);
    /// Forgets the links: patches are others, or there is no bake.
    void forget();

    /// The bake as it stands. References must be valid during the call.
    struct Bake {
        Baker& baker;
        const Scene& scene;
        const BakeSettings& settings;
        uint64_t version = 0;                                 // of its light
        const std::function<std::vector<glm::vec4>()>& light; // lighting of each patch [cd/m^2]
    };
    /// Returns the light where there is something new to tell, or once why there is none.
    std::optional<LitBalls> next(const Bake& bake);
    /// Tells whether new light waits for its time.
    bool owes() const { return owes_; }

private:
    uint64_t needed(const Bake& bake, size_t lamps) const;
    bool isTraced(const Bake& bake, const LampSet& lamps) const;
    void trace(const Bake& bake, const LampSet& lamps);
    LitBalls gather(const Bake& bake, const std::vector<LightSource>& sources) const;
    std::vector<LitBall> lit(const ProbeLinks& links, const ProbeLight& light) const;

    const vk::Device& device_;
    BallRequest request_, tracedFor_;
    std::unique_ptr<ProbeTracer> tracer_;
    size_t places_ = 0; // that the tracer was made for
    std::vector<shader::Lamp> lamps_;
    double moves_ = 0; // MoveCounters::seconds: objects stand as they did then
    std::optional<ProbeLinks> ball_, grid_;
    std::vector<LightSource> sources_; // of the last answer
    uint64_t version_ = 0;
    bool told_ = false, owes_ = false;
    std::string remark_; // that was told
    Clock::time_point at_{};
};

/// Returns the lights that shine in a bake, with their weights and switches as they are shown.
std::vector<LightSource> shiningSources(const Baker& baker, const Scene& scene);

} // namespace relume
