#include "app/live/arrival.h"

namespace relume {

void Arrival::ask(uint64_t changes) {
    asked_ = changes;
    answer_.reset();
    waits_ = false;
}

Arrival::Step Arrival::decide(uint64_t changes, bool unsaved) {
    if (answer_) return *answer_ ? Step::Comes : Step::IsRefused;
    waits_ = unsaved && changes != asked_;
    return waits_ ? Step::Waits : Step::Comes;
}

void Arrival::answer(bool comes) {
    answer_ = comes;
    waits_ = false;
}

} // namespace relume
