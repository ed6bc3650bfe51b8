#pragma once

namespace relume {

/// The settings of light transport, for all passes of a bake.
struct TransportSettings {
    float reflectivity = 1.0f;   // scales the albedo; RTRad: 0.9
    float distanceFactor = 1.0f; // RTRad preset only
    bool rtrad = false;          // RTRad's form factor, clamps and light skip
    bool allSend = false;        // dark chunks count as senders too: a pass of full length
    bool deviceGather =
        false; // the device's shaders gather also where its memory is the CPU's (host_links.h, host_pairs.h)
    bool reflectedOnly = false; // what patches send is without their emission, which is sampled by itself
};

} // namespace relume
