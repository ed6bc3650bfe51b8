#include "assets/foreign/blender_export.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/passing_folder.h"
#include "assets/foreign/blender_script.h"

#include <algorithm>
#include <cctype>
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

constexpr const char* kScript = "relume_link.py";

// Between fork and exec only what is safe there is called.
[[noreturn]] void becomeBlender(char* const* arguments, pid_t parent, const char* complaints) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    const int nothing = open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO})
        dup2(nothing, stream);
    const int file = open(complaints, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(file >= 0 ? file : nothing, STDERR_FILENO);
    execv(arguments[0], arguments);
    _exit(127);
}

int runBlender(std::vector<std::string> words, const std::string& path, const std::string& complaints) {
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t parent = getpid(), child = fork();
    if (child < 0)
        throw Error(
            fmt::format("{}: Blender does not start ({}): close other programs", path, std::strerror(errno)));
    if (child == 0) becomeBlender(arguments.data(), parent, complaints.c_str());
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

// Returns the Python module that Blender's exporter misses, "" where that is not what it complains about.
// Debian's Blender comes without numpy, by which it writes glTF files. Its own add-ons may miss others as
// Blender starts, which the export does without: they are told by a trace without the script and the
// exporter.
std::string missingModule(const std::string& complaints) {
    const std::string before = "ModuleNotFoundError: No module named '";
    std::ifstream file(complaints);
    std::string name;
    bool ours = true; // what is read is no trace of others
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("Traceback")) ours = false;
        if (line.find(kScript) != std::string::npos || line.find("io_scene_gltf") != std::string::npos)
            ours = true;
        if (ours && line.starts_with(before))
            name = line.substr(before.size(), line.rfind('\'') - before.size());
    }
    const bool plain =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
    return plain ? name : "";
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
    const std::string script = folder.file(kScript), level = folder.file("level.glb");
    std::ofstream(script, std::ios::binary) << blenderScript();
    const std::string complaints = folder.file("complaints.txt");
    const int status = runBlender({blender, "--background", "--factory-startup", "--disable-autoexec",
                                   fs::absolute(path).string(), "--python-exit-code", "1", "--python", script,
                                   "--", level, "--mean-sky"},
                                  path, complaints);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !fs::exists(level)) {
        const std::string missing = missingModule(complaints);
        if (!missing.empty())
            throw Error(fmt::format(
                "{}: Blender's Python lacks {}, by which it writes glTF files: install it (Debian: "
                "apt install python3-{})",
                path, missing, missing));
        throw Error(path + ": Blender cannot read it or write its glTF file: open it there and export it");
    }
    RegularFile file(level, "export the .blend file by hand");
    std::vector<uint8_t> bytes(file.size());
    file.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    return bytes;
}

} // namespace relume
