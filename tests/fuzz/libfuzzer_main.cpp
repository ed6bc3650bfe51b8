// libFuzzer has its own main(): it gets the corpus as a folder, as if that had been named.
#include "tests/fuzz/fuzz.h"

#include <cstdlib>
#include <string>
#include <vector>

#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <fstream>

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments);

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("none", std::make_shared<spdlog::sinks::null_sink_mt>()));
    static std::vector<char*> extended(*arguments, *arguments + *count);
    for (const char* argument : extended)
        if (std::filesystem::is_regular_file(argument) && argument != extended[0])
            return 0; // to be seen again
    static std::string folder = relume::fuzz::besideInputs("corpus");
    std::filesystem::create_directories(folder);
    size_t number = 0;
    for (const std::string& entry : relume::fuzz::corpus())
        std::ofstream(folder + "/" + std::to_string(number++), std::ios::binary) << entry;
    extended.push_back(folder.data());
    *count = static_cast<int>(extended.size());
    extended.push_back(nullptr);
    *arguments = extended.data();
    return 0;
}
