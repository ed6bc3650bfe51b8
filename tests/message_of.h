#pragma once

#include "assets/base/error.h"

#include <functional>
#include <string>

namespace relume {

/// Returns the message of the Error that `action` throws, nothing where it throws none.
inline std::string messageOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

} // namespace relume
