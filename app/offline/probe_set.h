#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assets/images/layered_exr.h"
#include "bake/probes/probe_grid.h"
#include "bake/probes/probe_light.h"

namespace relume {

/// Light probes as a bake made them: of all light, and light by light where it had layers.
struct ProbeSet {
    struct Layer {
        LayeredImage::Layer light; // name, weight and attributes as the layered lightmap has them; no image
        std::vector<Harmonics> radiance; // per probe, for a weight of 1
    };
    std::optional<ProbeGrid> grid; // that the probes are of, in its order; none: they are single ones
    std::vector<Probe> probes;     // all light together
    std::vector<Layer> layers;     // empty: the bake had none
};

/// Makes the probes' light the sum of weight x layer.
void sumLayers(ProbeSet& set);

/// Weighs the probes' layers as those of a lightmap are weighed, and sums them; no rays. Throws Error where
/// the lights differ, as those of two bakes may, or there are no layers.
void weighLike(ProbeSet& set, const LayeredImage& image);

/// Throws Error, which begins with the path, where a probe's light is not finite.
void requireFiniteLight(const Harmonics& radiance, const std::string& path);

/// Returns them as JSON text. Throws Error for light that is not finite; `path` names the file.
std::string probesJson(const ProbeSet& set, const std::string& path);
/// Reads such text. Throws Error, which begins with the path, where anything is missing or odd.
ProbeSet parseProbes(const std::string& text, const std::string& path);

} // namespace relume
