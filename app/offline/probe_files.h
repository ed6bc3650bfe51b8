#pragma once

#include <string>

#include "app/offline/probe_set.h"

namespace relume {

/// Tells what a file of probes is for, by its name.
enum class ProbeForm {
    Relume, // .json: all that is known, which is read again
    Three,  // .three.json: light probes of three.js
    Bevy,   // .ktx2: an irradiance volume of Bevy, of a grid only
};

/// Throws UsageError where no form of probes goes with the file's name; `option` named it.
ProbeForm probeFormOf(const std::string& option, const std::string& path);

/// Reads a .json that writeProbes wrote. Throws Error.
ProbeSet readProbes(const std::string& path);

/// Returns a file of probes in the form that its name asks for. Throws Error, also where there is no grid and
/// the form needs one.
std::string probeBytes(const std::string& path, const ProbeSet& set);

/// Says where Bevy has the volume of a grid: "translation X, Y, Z, scale X, Y, Z".
std::string volumePlace(const ProbeGrid& grid);

/// Writes probes in the form that the file's name asks for, under a temporary name that is then changed.
/// Throws Error as probeBytes() does.
void writeProbes(const std::string& path, const ProbeSet& set);

} // namespace relume
