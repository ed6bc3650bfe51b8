#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace relume {

/// Hears from the system at once when a program has closed one of some files after writing it, or has renamed
/// one to take its place (inotify). Where the system does not tell, as on some network drives, nothing is
/// ever heard: whoever needs to know looks at the files now and then as well. It is for a single thread,
/// which is called by `wake` from another one.
class FileNews {
public:
    explicit FileNews(std::function<void()> wake);
    ~FileNews();
    FileNews(const FileNews&) = delete;
    FileNews& operator=(const FileNews&) = delete;

    /// Follows these files from now on, and no others. It costs little where they are those of before.
    void follow(const std::vector<std::string>& paths);
    /// Tells whether one of them was finished since it was asked last.
    bool take() { return finished_.exchange(false); }

private:
    /// One listening thread for one list of files.
    class Listener;

    std::function<void()> wake_;
    std::vector<std::string> paths_;
    std::atomic<bool> finished_ = false;
    std::unique_ptr<Listener> listener_;
};

} // namespace relume
