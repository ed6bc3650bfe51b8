#pragma once

#include <functional>
#include <utility>

#include "assets/base/watch.h"

namespace relume {

/// Passes on to a function how a preparation stands.
class Hearer final : public Watch {
public:
    using Hear = std::function<void(const char* phase, double done)>;
    explicit Hearer(Hear hear) : hear_(std::move(hear)), scope_(*this) {}
    void hear(const char* phase, double done) override { hear_(phase, done); }

private:
    Hear hear_;
    WatchScope scope_;
};

} // namespace relume
