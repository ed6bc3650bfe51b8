#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

/// Reads one input, as libFuzzer calls it; each target defines this. It comes back from whatever is in there;
/// what a reader must not do (crash, hang, take much memory, throw anything but Error) ends the process.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace relume::fuzz {

/// Returns small inputs to begin with, good ones and what readers once failed at; each target defines this,
/// too.
std::vector<std::string> corpus();

/// Writes the input to a file whose name ends with `ending`, a new one each time, in a folder of this
/// process. Returns its path.
std::string asFile(const uint8_t* data, size_t size, const std::string& ending);
/// Returns a path in the same folder.
std::string besideInputs(const std::string& name);

/// Ends the process where a message is not one line that begins with `path` or its folder's.
void checkMessage(const std::exception& error, const std::string& path);
/// Ends the process, saying why, where `good` is false.
void check(bool good, const std::string& why);

/// Returns input `run` of a seed: the corpus first, then entries of it with some changes. It depends on
/// nothing else.
std::string inputOf(const std::vector<std::string>& corpus, uint64_t seed, uint64_t run);

} // namespace relume::fuzz
