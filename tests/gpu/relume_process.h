#pragma once

#include <functional>
#include <string>
#include <vector>

namespace relume {

/// Holds the outcome of a run of a program, with its outputs caught.
struct ProcessResult {
    int status = -1; // exit status; 128 + signal where one ended it
    std::string out, err;
};

/// Runs the relume executable as a user starts it. `onErr` sees all of stderr so far whenever more has come,
/// and returns a signal to send, or 0. SIGKILL ends the run after `killAfter` seconds; 0: never.
ProcessResult runRelume(const std::vector<std::string>& arguments,
                        const std::function<int(const std::string& err)>& onErr = nullptr,
                        double killAfter = 0);
/// Runs another program, given by path, in the same way.
ProcessResult runProgram(const std::string& program, const std::vector<std::string>& arguments,
                         const std::function<int(const std::string& err)>& onErr = nullptr,
                         double killAfter = 0);

} // namespace relume
