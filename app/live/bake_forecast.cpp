#include "app/live/bake_forecast.h"

#include <cmath>

namespace relume {

double secondsUntil(std::span<const ConvergencePoint> history, double aim, double ConvergencePoint::*error) {
    if (history.size() < 2 || aim <= 0) return -1;
    const ConvergencePoint now = history.back();
    if (now.*error <= aim) return 0;
    size_t then = history.size() - 2;
    while (then > 0 && history[then].seconds > 0.5 * now.seconds)
        --then;
    const ConvergencePoint before = history[then];
    if (!(before.seconds > 0 && before.seconds < now.seconds && before.*error > now.*error)) return -1;
    const double power = std::log(before.*error / now.*error) / std::log(now.seconds / before.seconds);
    return now.seconds * (std::pow(now.*error / aim, 1.0 / power) - 1.0);
}

void RayMeter::add(double seconds, uint64_t rays) {
    const Mark mark{seconds, rays};
    if (count_ == 0 || rays < newest_.rays) {
        oldest_ = middle_ = newest_ = mark;
        count_ = 1;
        return;
    }
    newest_ = mark;
    ++count_;
    if (newest_.seconds - middle_.seconds < 0.5 * kWindow) return;
    if (newest_.seconds - oldest_.seconds >= kWindow) oldest_ = middle_;
    middle_ = newest_;
}

double RayMeter::perSecond() const {
    const double seconds = newest_.seconds - oldest_.seconds;
    return seconds > 0 ? static_cast<double>(newest_.rays - oldest_.rays) / seconds : 0.0;
}

} // namespace relume
