#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/live/bake_inspection.h"
#include "app/live/layer_probes.h"
#include "app/live/light_maps.h"
#include "app/live/map_slots.h"
#include "assets/base/clock.h"

namespace relume {

/// Brings what a bake has found to the exchange, as maps: its light, what a user looks at in its place, and
/// layers at single texels. Only the bake thread uses it.
class MapPublisher {
public:
    /// Decides how images reach OpenGL. Throws Error when they must be shared and cannot be.
    MapPublisher(const vk::Device& device, LightmapExchange& exchange, const MapSlots::Desc& desc);

    /// Tells what was chosen, with the reason: "shared (OpenGL and Vulkan use one device)".
    const std::string& choice() const { return slots_.choice(); }

    /// A bake for begin(). The references must stay valid until end().
    struct Bake {
        Baker& baker;
        uint64_t number = 0;
        KeptLight kept = KeptLight::None;
        uint32_t rings = 4; // of texels filled around charts
        const BakeSettings& settings;
    };
    void begin(const Bake& bake);
    /// Says that the bake goes on with another number, because its lights or surfaces were edited. A map of
    /// it follows, even if the edit changes nothing that can be seen.
    void edited(uint64_t number);
    /// Ends the bake. Texels that were drawn stay; what they were made of goes.
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
    /// Returns the number of the light as the solver has it now. Needs a bake.
    uint64_t lightVersion() { return askSolver().version; }
    /// Returns the bake as one looks at it, beside its light. Needs a bake.
    BakeInspection& inspection() { return running_->inspection; }

private:
    struct Running {
        Bake bake;
        BakeInspection inspection;
    };
    /// The newest map of what a user looks at.
    struct Inspected {
        MapSource source;
        uint64_t version = 0; // of the light that it goes with
        Clock::time_point at{};
    };
    MapSource makeSource() const;
    LiveLight askSolver();
    bool publishLight();
    bool publishInspected(const InspectRequest& request);
    bool publishProbe();
    std::optional<uint32_t> claim(uint32_t size);
    void hand(const MapSource& source, uint32_t slot, PublishedMap map);

    const vk::Device& device_;
    LightmapExchange& exchange_;
    MapSlots slots_;
    LayerProbes probes_;
    std::optional<Running> running_;
    LightMaps light_;
    Inspected inspected_;
    std::optional<InspectRequest> shown_; // by the newest map, once there is one
    bool owes_ = false;
};

} // namespace relume
