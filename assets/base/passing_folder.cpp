#include "assets/base/passing_folder.h"

#include "assets/base/error.h"

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace relume {

PassingFolder::PassingFolder(const std::string& name) {
    std::error_code code;
    path_ = (std::filesystem::temp_directory_path(code) / (name + "_XXXXXX")).string();
    if (code || mkdtemp(path_.data()) == nullptr)
        throw Error(fmt::format("{}: cannot be made ({}): make room in the system's temporary folder", path_,
                                std::strerror(errno)));
}

PassingFolder::~PassingFolder() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
}

} // namespace relume
