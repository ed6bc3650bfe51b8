#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "assets/model/scene.h"
#include "layer_facts.h"
#include "no_device.h"

namespace relume {

/// Bakes a scene's layers without light: it carries out what a schedule decides as LayerSolver does, and
/// watches that no decision is against the rules. Jobs take a few batches. How far a level is off is a
/// function of the light, of where it and objects are, of colours and of the level.
class FakeBake {
public:
    struct Desc {
        ScheduleRules rules;
        uint32_t lamps = 3;
        uint64_t room = 64; // layers that there is memory for, with former ones and a spare one
        size_t lanes = 8;   // layers that there is memory for to bounce together
        uint32_t seed = 1;  // of noise and of how long jobs take
    };
    explicit FakeBake(const Desc& desc);

    Scene scene; // scripts change it, and the switches, and tell edit()
    LightMix mix;
    void addLamp();
    void edit();

    void step();
    /// Makes steps until all is done; `most` at most.
    void finish(int most = 5000);
    bool done() const { return done_; }
    bool waits() const { return edited_; } // an edit is not taken yet
    bool unseen() const { return unseen_; }
    bool showsSum() const { return sumShown_; }
    bool atRest() const { return schedule_.atRest(layers(), now()); }
    const LayerSchedule::Layers& layers() const { return store_->layers(); }
    const LayerSchedule& schedule() const { return schedule_; }

    /// Returns what was against the rules, "" for nothing.
    const std::string& wrong() const { return wrong_; }
    /// Returns all steps; those that follow one another and are alike are one, with their number.
    std::string steps() const;
    /// Returns the levels of each light in the order in which it had them.
    const std::map<std::string, std::vector<std::string>>& levels() const { return levels_; }

private:
    struct Direct {
        Layer* layer = nullptr;
        LayerLevel target;
        bool alone = false;
        std::optional<uint32_t> repaired; // step, while dirty chunks are repaired
    };
    struct Lane {
        Layer* layer = nullptr;
        LayerLevel target;
        uint32_t left = 1; // batches
    };
    struct Bounce {
        std::vector<Lane> lanes;
        bool sum = false;
    };
    enum class End : uint8_t { NotYet, Made, Paused, Repaired };

    ScheduleState now() const;
    bool isBusy() const { return !std::holds_alternative<std::monostate>(job_); }
    bool canSum() const { return schedule_.canSum(layers(), sumShown_); }
    bool wantsSum() const { return schedule_.wantsSum(layers(), sumShown_); }
    void require(bool holds, const std::string& rule);
    void checkStep(const LayerSchedule::Step& step, bool dropped);
    void checkLanes(const Bounce& job);

    void batch();
    void relink();
    void begin(const LayerSchedule::BeginLayer& next);
    End beginDirect();
    End directBatch();
    End repairBatch(Direct& job);
    void endDirect(End end);
    void endRepair();
    void beginBounces(Layer& leader, LayerLevel target);
    void beginSum();
    void bounceBatch();
    void finishLevel(Layer& layer, LayerLevel target);
    void abort();

    void weigh();
    void adopt();
    void adoptLayers();
    void inherit(const Layer& from, Layer& to) const;
    void markMoved(Layer& layer) const;
    bool isUnderWay(const Layer* layer) const;
    std::vector<WantedLayer> wanted() const;
    uint32_t randomOf(const Layer& layer, uint32_t what) const;

    Desc desc_;
    LayerSchedule schedule_;
    StoreWithoutDevice store_;
    SceneStates states_;
    std::variant<std::monostate, Direct, Bounce> job_;
    Layer sum_;
    std::vector<glm::mat4> places_; // of objects, as they were taken up
    bool moved_ = false, edited_ = false, unseen_ = false, done_ = false;
    bool sumDue_ = false, sumShown_ = false, droppedForSum_ = false;
    std::optional<uint32_t> relink_;
    uint32_t keptSamplePasses_ = 0; // sample passes of links that are kept
    std::vector<std::string> steps_;
    std::map<std::string, std::vector<std::string>> levels_;
    std::string wrong_;
};

} // namespace relume
