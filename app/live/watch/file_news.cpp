#include "app/live/watch/file_news.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

namespace relume {

class FileNews::Listener {
public:
    /// `heard` is called by the listening thread.
    Listener(const std::vector<std::string>& paths, std::function<void()> heard)
        : heard_(std::move(heard)), events_(inotify_init1(IN_CLOEXEC | IN_NONBLOCK)),
          end_(eventfd(0, EFD_CLOEXEC)) {
        if (events_ < 0 || end_ < 0) return;
        for (const std::string& path : paths)
            add(path);
        if (!names_.empty()) thread_ = std::thread([this] { listen(); });
    }
    ~Listener() {
        if (thread_.joinable()) {
            const uint64_t one = 1;
            while (write(end_, &one, sizeof(one)) < 0 && errno == EINTR) {
            }
            thread_.join();
        }
        for (const int descriptor : {events_, end_})
            if (descriptor >= 0) close(descriptor);
    }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

private:
    // A file that is replaced is another one afterwards, so its folder is what is watched.
    void add(const std::string& path) {
        const std::filesystem::path file(path);
        const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
        const int watch = inotify_add_watch(events_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO);
        if (watch >= 0) names_[watch].insert(file.filename().string());
    }

    void listen() {
        std::array<pollfd, 2> wanted{{{events_, POLLIN, 0}, {end_, POLLIN, 0}}};
        while (true) {
            if (poll(wanted.data(), wanted.size(), -1) < 0) {
                if (errno == EINTR) continue;
                return;
            }
            if (wanted[1].revents != 0) return;
            if (wanted[0].revents != 0 && readEvents()) heard_();
        }
    }

    // Returns whether one of the files was finished.
    bool readEvents() {
        bool one = false;
        alignas(inotify_event) std::array<std::byte, 16384> buffer;
        ssize_t size = 0;
        while ((size = read(events_, buffer.data(), buffer.size())) > 0) {
            for (ssize_t at = 0; at < size;) {
                inotify_event event;
                std::memcpy(&event, &buffer[static_cast<size_t>(at)], sizeof(event));
                const char* name =
                    reinterpret_cast<const char*>(&buffer[static_cast<size_t>(at)]) + sizeof(event);
                const auto names = names_.find(event.wd);
                one |= (event.mask & IN_Q_OVERFLOW) != 0;
                one |= event.len > 0 && names != names_.end() && names->second.contains(name);
                at += static_cast<ssize_t>(sizeof(event) + event.len);
            }
        }
        return one;
    }

    std::function<void()> heard_;
    int events_ = -1, end_ = -1;
    std::map<int, std::set<std::string>> names_; // of files, by the watch of their folder
    std::thread thread_;
};

FileNews::FileNews(std::function<void()> wake) : wake_(std::move(wake)) {}

FileNews::~FileNews() = default;

void FileNews::follow(const std::vector<std::string>& paths) {
    if (paths == paths_) return;
    paths_ = paths;
    listener_.reset();
    if (paths.empty()) return;
    listener_ = std::make_unique<Listener>(paths, [this] {
        finished_ = true;
        wake_();
    });
}

} // namespace relume
