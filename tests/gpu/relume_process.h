#pragma once

#include <functional>
#include <string>
#include <vector>

namespace relume {

/// A run of the relume executable as a user starts it, its outputs caught.
struct ProcessResult {
    int status = -1; // exit status; 128 + signal where one ended it
    std::string out, err;
};

/// `onErr` sees all of stderr so far whenever more has come, and returns a signal to send, or 0. killAfter:
/// the seconds after which SIGKILL ends it; 0: never.
ProcessResult runRelume(const std::vector<std::string>& arguments,
                        const std::function<int(const std::string& err)>& onErr = nullptr,
                        double killAfter = 0);
/// The same for another program, by path.
ProcessResult runProgram(const std::string& program, const std::vector<std::string>& arguments,
                         const std::function<int(const std::string& err)>& onErr = nullptr,
                         double killAfter = 0);

} // namespace relume
