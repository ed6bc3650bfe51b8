#pragma once

#include <string>
#include <vector>

namespace relume {

/// Returns the names that `typed` may have been meant for, best first, at most 4: those that differ by case
/// or by a few letters, or hold it.
std::vector<std::string> nearNames(const std::string& typed, const std::vector<std::string>& names);

/// Returns the end of a message that `typed` is none of `names`: "did you mean 'Lamp'?", else what there is.
std::string nearNamesHint(const std::string& typed, const std::vector<std::string>& names);

} // namespace relume
