#include "assets/foreign/blender_export.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/passing_folder.h"
#include "assets/foreign/blender_script.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

// Between fork and exec only what is safe there is called.
[[noreturn]] void becomeBlender(char* const* arguments, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    const int nothing = open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        dup2(nothing, stream);
    execv(arguments[0], arguments);
    _exit(127);
}

int runBlender(std::vector<std::string> words, const std::string& path) {
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t parent = getpid(), child = fork();
    if (child < 0)
        throw Error(
            fmt::format("{}: Blender does not start ({}): close other programs", path, std::strerror(errno)));
    if (child == 0) becomeBlender(arguments.data(), parent);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

} // namespace

std::optional<std::string> findBlender() {
    const char* folders = std::getenv("PATH");
    std::istringstream all(folders != nullptr ? folders : "");
    for (std::string folder; std::getline(all, folder, ':');) {
        const std::string program = folder + "/blender";
        if (!folder.empty() && access(program.c_str(), X_OK) == 0) return program;
    }
    return std::nullopt;
}

std::vector<uint8_t> exportByBlender(const std::string& blender, const std::string& path) {
    const PassingFolder folder(fs::temp_directory_path(), "relume_blend_");
    const std::string script = folder.file("relume_link.py"), level = folder.file("level.glb");
    std::ofstream(script, std::ios::binary) << blenderScript();
    const int status = runBlender({blender, "--background", "--factory-startup", "--disable-autoexec",
                                   fs::absolute(path).string(), "--python-exit-code", "1", "--python", script,
                                   "--", level, "--mean-sky"},
                                  path);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !fs::exists(level))
        throw Error(path + ": Blender cannot read it or write its glTF file: open it there and export it");
    RegularFile file(level, "export the .blend file by hand");
    std::vector<uint8_t> bytes(file.size());
    file.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    return bytes;
}

} // namespace relume
