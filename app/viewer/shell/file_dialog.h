#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/viewer/window/path_completion.h"

namespace relume {

/// Asks for a path, which is typed with completion. It asks for one at a time.
class FileDialog {
public:
    struct Desc {
        std::string title, path;          // path: the text that it begins with
        std::vector<std::string> endings; // of files that are listed
        std::vector<std::string> recent;  // paths to choose from
        bool saves = false;               // a file that exists is taken only after a question
        bool folder = false;              // a folder is asked for
        std::function<void(const std::string& path)> done;
    };
    void open(Desc desc);
    void close() { open_ = false; }
    bool isOpen() const { return open_; }
    void draw();

private:
    void complete();
    void list(const std::vector<std::string>& paths, const char* id);
    void finish();

    Desc desc_;
    bool open_ = false, focus_ = false, asks_ = false;
    bool toEnd_ = false;         // the cursor goes behind the path
    int opened_ = 0;             // how often
    std::string typed_, listed_; // listed_: the text that `completion_` is about
    PathCompletion completion_;
};

} // namespace relume
