#include "tests/fuzz/fuzz.h"
#include "tests/temporary_folder.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace relume::fuzz {
namespace {

/// Returns the folder for inputs. It is in memory where there is a file system in it, since a disk would be
/// flushed for each file that is written.
const TemporaryFolder& inputFolder() {
    static const TemporaryFolder folder = [] {
        if (access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
        return TemporaryFolder();
    }();
    return folder;
}

} // namespace

std::string besideInputs(const std::string& name) {
    return inputFolder().path(name);
}

std::string asFile(const uint8_t* data, size_t size, const std::string& ending) {
    const std::string path = besideInputs("input" + ending);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    file.close();
    check(file.good(), path + " cannot be written");
    return path;
}

void check(bool good, const std::string& why) {
    if (good) return;
    std::fprintf(stderr, "fuzz: %s\n", why.c_str());
    std::abort();
}

void checkMessage(const std::exception& error, const std::string& path) {
    const std::string message = error.what();
    check(message.find('\n') == std::string::npos, "a message of several lines: " + message);
    check(message.starts_with(std::filesystem::path(path).parent_path().string()),
          "a message that does not name its file: " + message);
}

} // namespace relume::fuzz
