#pragma once

#include <string>
#include <vector>

namespace relume {

/// Collects warnings about a scene's things and puts those of one kind in one line: "room.glb: mesh 'A' and 3
/// more: problem".
class Warnings {
public:
    /// Adds a warning. The same problem of the same thing, reported again right after, counts once.
    void add(const std::string& thing, const std::string& problem);
    std::vector<std::string> lines(const std::string& path) const; // path: "" leaves it out

private:
    struct Entry {
        std::string first, last, problem;
        size_t count = 1;
    };
    std::vector<Entry> entries_;
};

/// Returns a name from a file made fit for a one-line message: quoted, without control characters, shortened.
std::string inQuotes(const std::string& name);

} // namespace relume
