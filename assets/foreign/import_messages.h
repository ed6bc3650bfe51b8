#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace relume {

/// Holds what a process that converts a file says, line by line.
enum class ImportWord : char {
    Progress = 'p', // a number from 0 to 1
    Warning = 'w',  // one of the scene's
    Error = 'e',    // what of the file is wrong
    Memory = 'm',   // there is not enough of it
    Done = 'd',     // the whole GLB is written
};

/// Takes a stream of such lines apart, whatever pieces it comes in.
class ImportMessages {
public:
    using Hear = std::function<void(ImportWord word, const std::string& text)>;
    explicit ImportMessages(Hear hear) : hear_(std::move(hear)) {}
    void take(std::string_view bytes);

private:
    Hear hear_;
    std::string line_;
};

/// Returns a message as one line with its end.
std::string importLine(ImportWord word, std::string text);

} // namespace relume
