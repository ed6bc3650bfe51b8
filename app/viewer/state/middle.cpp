#include "app/viewer/state/middle.h"

#include <array>
#include <utility>

namespace relume {

std::string middleName(const Middle& middle) {
    const char* below = middle.startPage ? "start page" : "scene";
    switch (middle.card) {
    case Middle::Card::Opening:
        return std::string("opening over ") + below;
    case Middle::Card::Failure:
        return std::string("failure over ") + below;
    case Middle::Card::Notice:
        return std::string("notice over ") + below;
    default:
        return below;
    }
}

std::string loadingWords(const std::string& phase) {
    constexpr std::array<std::pair<const char*, const char*>, 6> kWords = {{
        {"loading", "Reading the file"},
        {"drawing the geometry", "Making the geometry"},
        {"unwrapping", "Making lightmap UVs"},
        {"packing charts", "Packing the charts of the lightmap"},
        {"atlas", "Laying out the lightmap"},
        {"triangles", "Placing the triangles"},
    }};
    for (const auto& [known, words] : kWords)
        if (phase == known) return words;
    return phase.empty() ? kWords.front().second : phase;
}

void Opening::begin(const std::string& path, double time) {
    path_ = path;
    begun_ = time;
    failure_.reset();
    startWanted_ = false;
}

void Opening::fail(OpenFailure failure) {
    path_.clear();
    failure_ = std::move(failure);
}

void Opening::sceneCame() {
    path_.clear();
    noticePutAway_.clear();
}

void Opening::wantStart() {
    failure_.reset();
    startWanted_ = true;
}

bool Opening::putAway(const Facts& facts) {
    const Middle now = middle(facts);
    if (now.card == Middle::Card::Failure) {
        failure_.reset();
        return true;
    }
    if (now.card == Middle::Card::Notice) {
        noticePutAway_ = facts.notice;
        return true;
    }
    return now.startPage && facts.scene && std::exchange(startWanted_, false);
}

Middle Opening::middle(const Facts& facts) const {
    Middle middle{.startPage = startWanted_ || (!facts.scene && !opens(facts))};
    if (opens(facts)) {
        if (!facts.scene || facts.time - begun_ >= kPatience) middle.card = Middle::Card::Opening;
    } else if (failure_) {
        middle.card = Middle::Card::Failure;
    } else if (!middle.startPage && !facts.notice.empty() && facts.notice != noticePutAway_) {
        middle.card = Middle::Card::Notice;
    }
    return middle;
}

} // namespace relume
