#pragma once

#include <string>

#include "app/offline/probe_set.h"
#include "assets/images/float_image.h"

namespace relume {

/// Returns the probes of a grid with those inside walls replaced: where light is interpolated between probes,
/// these would darken a wall's neighbourhood. Each takes the mean of its neighbours along the axes, layer by
/// layer from those that stand free; where none does, all stay as they are.
std::vector<Harmonics> freeRadiance(const ProbeGrid& grid, const std::vector<Probe>& probes);

/// Returns the ambient cubes of a grid of Rx x Ry x Rz probes as Bevy's IrradianceVolume has them: lighting =
/// irradiance / pi [cd/m^2], without negative values, on surfaces that face the six axes, a 3D texture of Rx
/// x 2 Ry x 3 Rz texels whose slices lie one beneath another in this image. The side +X of probe (x, y, z) is
/// at (x, y, z), -X at (x, Ry + y, z); the sides of Y follow Rz slices later, those of Z 2 Rz. Bevy's shader
/// has it so (bevy_pbr, irradiance_volume.wgsl); its page has the halves the other way round.
FloatImage ambientCubes(const ProbeGrid& grid, const std::vector<Probe>& probes);

/// Returns why the grid is no volume that graphics devices hold, and what helps; "" where it is one.
std::string volumeProblem(const ProbeGrid& grid);

/// Returns the probes as three.js' ObjectLoader reads them: a group of LightProbe objects, whose `sh` are the
/// coefficients as they are, each in its place. `path` names the file in an Error about light that is not
/// finite.
std::string threeProbes(const ProbeSet& set, const std::string& path);

} // namespace relume
