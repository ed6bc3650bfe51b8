#pragma once

#include <future>
#include <optional>
#include <string>

#include "assets/model/scene.h"

namespace relume {

/// Reads pictures of the sky beside the main thread.
class SkyPictures {
public:
    struct Result {
        Sky sky;             // with its file and pixels ...
        std::string error;   // ... unless this says why not, one line
        bool chosen = false; // by the user, not by the document
    };
    ~SkyPictures();
    /// Begins to read a picture. The newest request counts.
    void read(const std::string& file, bool chosen);
    /// Forgets whatever is being read or is next: another scene came.
    void forget();
    /// Returns the file that is being read or is next; "": none.
    const std::string& reading() const { return reading_; }
    /// Returns the result of a read() once, as soon as it is there.
    std::optional<Result> poll();

private:
    struct Wish {
        std::string file;
        bool chosen = false;
    };
    void begin(Wish wish);

    std::future<Result> result_;
    std::optional<Wish> next_; // instead of what is being read
    std::string reading_;      // "": nobody wants what is read
};

} // namespace relume
