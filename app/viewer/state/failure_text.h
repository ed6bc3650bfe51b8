#pragma once

#include <string>

#include "app/live/session.h"

namespace relume {

/// The parts of a message about a file that could not be opened, or not be drawn.
struct FailureText {
    std::string title;
    std::string name, folder; // of the file
    std::string thing;        // what is wrong
    std::string mend;         // what helps; never ""
};

/// Takes a message apart. Those of this program are "FILE: THING: MEND"; where one has less, the rest is
/// filled in, and what is wrong with another file (one that the scene names) keeps that file's name.
FailureText failureText(const OpenFailure& failure);

/// Returns the end of a text behind "...", as much as `fits` allows; the whole text where that fits. Of a
/// path the end tells most.
template<typename Fits>
std::string endOf(const std::string& text, const Fits& fits) {
    if (fits(text)) return text;
    // What fits is looked for by halves: a longer end is never narrower.
    size_t few = 0, many = text.size();
    const auto shortened = [&](size_t count) {
        size_t from = text.size() - count;
        // A letter of UTF-8 stays whole.
        while (from < text.size() && (static_cast<unsigned char>(text[from]) & 0xc0u) == 0x80u)
            ++from;
        return "..." + text.substr(from);
    };
    while (many - few > 1) {
        const size_t middle = few + (many - few) / 2;
        (fits(shortened(middle)) ? few : many) = middle;
    }
    return shortened(few);
}

} // namespace relume
