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

/// Writes probes in the form that the file's name asks for, under a temporary name that is then changed.
/// Throws Error, also where there is no grid and the form needs one.
void writeProbes(const std::string& path, const ProbeSet& set);

} // namespace relume
