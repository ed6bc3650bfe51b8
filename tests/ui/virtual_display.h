#pragma once

#include <string>

#include <sys/types.h>

namespace relume {

/// An X server without a screen (Xvfb), for as long as it lives.
class VirtualDisplay {
public:
    VirtualDisplay(int width, int height); // throws Error when Xvfb does not start
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    const std::string& name() const { return name_; } // as DISPLAY has it

private:
    pid_t server_ = -1;
    std::string name_;
};

} // namespace relume
