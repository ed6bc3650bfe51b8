#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "app/live/bake_desk.h"
#include "app/live/layer_probes.h"
#include "assets/base/clock.h"
#include "bake/show/patch_inspector.h"
#include "bake/show/publisher.h"

namespace relume {

/// Brings what a bake has found to the exchange, as maps. It decides between shared images and plain memory,
/// and keeps the light of the bake before until the new one has a solution. Only the bake thread uses it.
class MapPublisher {
public:
    struct Desc {
        DisplayMode display = DisplayMode::Auto;
        DisplayHost host;
    };
    /// Decides how images reach OpenGL. Throws Error when they must be shared and cannot be.
    MapPublisher(const vk::Device& device, LightmapExchange& exchange, const Desc& desc);

    /// Tells what was chosen, with the reason: "shared (OpenGL and Vulkan use one device)".
    const std::string& choice() const { return choice_; }

    /// A bake for begin(). The references must stay valid until end().
    struct Bake {
        Baker& baker;
        uint64_t number = 0;
        bool keepLight = false; // what is shown stays until there is a solution with all bounces
        uint32_t rings = 4;     // of texels filled around charts
        const BakeSettings& settings;
    };
    void begin(const Bake& bake);
    /// Says that the bake goes on with another number, because its lights or surfaces were edited. A map of
    /// it follows, even if the edit changes nothing that can be seen.
    void edited(uint64_t number);
    void end();

    /// Sends the layers at these texels to the exchange, one with each publish() while there are any to tell.
    void setProbes(ProbeRequest request) { probes_.ask(std::move(request)); }

    /// Publishes what was asked for, where there is something new and a slot to write. Returns whether it
    /// did.
    bool publish(const InspectRequest& request);
    /// Tells whether something new is left to publish: it waits for a slot or its time, or is the next probe.
    bool owes() const { return owes_; }

    /// Returns the light as the solver has it now for each patch. Needs a bake.
    std::vector<glm::vec4> lightNow();
    /// Returns the light paths of the patch at this texel, or nothing beside all charts. Needs a bake.
    std::optional<InspectPaths> paths(uint32_t texel);
    InspectVoxels voxels(uint32_t resolution) const;

private:
    /// A publisher that writes maps of one kind, and what goes with each map.
    struct Source {
        std::unique_ptr<Publisher> publisher;
        uint64_t bake = 0;
        bool radiance = false, filled = true;
    };
    /// Images that the drawing thread may still use.
    struct FormerImages {
        uint32_t set = 0;
        std::array<vk::SharedImage, Publisher::kSlots> images;
    };
    void choose();
    Source makeSource() const;
    LiveLight askSolver();
    bool publishLight();
    bool publishInspected(const InspectRequest& request);
    PatchValues inspect(const InspectRequest& request);
    PatchValues layerOf(const InspectRequest& request);
    bool publishProbe();
    PatchValues leafColors(const PairSettings& preview);
    uint32_t patchAt(uint32_t texel) const;
    void offer();
    void takeBackFormer();
    std::optional<uint32_t> claim(uint32_t size);
    void write(Source& source, uint32_t slot, PublishedMap map);

    const vk::Device& device_;
    LightmapExchange& exchange_;
    Desc desc_;
    bool shared_ = false;
    std::string choice_;
    uint32_t set_ = 0, setSize_ = 0;
    std::array<vk::SharedImage, Publisher::kSlots> images_;
    std::vector<FormerImages> former_;
    LayerProbes probes_;

    std::optional<Bake> bake_;
    std::optional<PatchInspector> inspector_;
    Source light_, next_, inspected_; // next_: takes light_'s place once there is a solution
    std::vector<ChunkRange> changed_; // since light_'s or next_'s last update
    uint64_t drawnVersion_ = 0;       // of the solver's light that light_ holds; 0: none of this bake
    bool edited_ = false;             // since the newest map
    bool owes_ = false;
    InspectRequest shown_; // by the newest map
    bool anyShown_ = false;
    const Publisher* writer_ = nullptr; // of the newest map
    uint64_t inspectedVersion_ = 0;
    Clock::time_point inspectedAt_{};
};

} // namespace relume
