#include "shaders/shader_library.h"

#include "assets/base/error.h"
#include "shaders/embedded_shaders.h"
#include "shaders/shader_compiler.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>

namespace relume {

namespace {

struct Program {
    std::string name, file;
    std::vector<std::string> definitions;
};

struct Folder {
    std::mutex mutex;
    std::string path; // "": the embedded code
};

Folder& folder() {
    static Folder instance;
    return instance;
}

std::vector<Program> readPrograms(const std::string& path) {
    const std::string list = (std::filesystem::path(path) / "programs.txt").string();
    std::ifstream file(list);
    if (!file) throw Error(list + ": cannot be read: give --shaders a copy of Relume's shaders folder");
    std::vector<Program> programs;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        Program program;
        if (!(words >> program.name) || program.name[0] == '#') continue;
        if (!(words >> program.file)) throw Error(list + ": '" + program.name + "' names no source file");
        for (std::string word; words >> word;)
            program.definitions.push_back(word);
        programs.push_back(std::move(program));
    }
    return programs;
}

std::string readText(const std::string& path, const std::string& user) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(path + ": cannot be read: " + user);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<uint32_t> compileFrom(const std::string& path, const std::string& name) {
    for (const Program& program : readPrograms(path)) {
        if (program.name != name) continue;
        const std::string source = (std::filesystem::path(path) / program.file).string();
        const std::string text = readText(source, "shader '" + name + "' needs it");
        return compileShader(
            {.name = source, .text = text, .definitions = program.definitions, .includeFolder = path});
    }
    throw Error(path + "/programs.txt: does not list shader '" + name +
                "': take the list of this version of Relume");
}

} // namespace

std::string shaderFolder() {
    const std::lock_guard lock(folder().mutex);
    return folder().path;
}

std::vector<uint32_t> shaderCode(const std::string& name) {
    const std::string path = shaderFolder();
    if (!path.empty()) return compileFrom(path, name);
    for (const EmbeddedShader& shader : embeddedShaders())
        if (name == shader.name) return {shader.code.begin(), shader.code.end()};
    throw Error("shader '" + name +
                "' is not part of this executable: list it in shaders/programs.txt and build again");
}

std::string shaderText(const std::string& path) {
    const std::string root = shaderFolder();
    if (!root.empty()) return readText((std::filesystem::path(root) / path).string(), "pictures need it");
    for (const EmbeddedText& text : embeddedTexts())
        if (path == text.path) return text.text;
    throw Error("shader source '" + path +
                "' is not part of this executable: only shaders/gl and what CMake lists "
                "beside it are");
}

std::vector<std::string> shaderNames() {
    std::vector<std::string> names;
    const std::string path = shaderFolder();
    if (path.empty())
        for (const EmbeddedShader& shader : embeddedShaders())
            names.emplace_back(shader.name);
    else
        for (const Program& program : readPrograms(path))
            names.push_back(program.name);
    return names;
}

void setShaderFolder(const std::string& path) {
    if (!path.empty()) {
        for (const Program& program : readPrograms(path)) {
            const std::filesystem::path source = std::filesystem::path(path) / program.file;
            if (!std::filesystem::exists(source))
                throw Error(source.string() + ": missing: give --shaders a copy of Relume's shaders folder");
        }
    }
    const std::lock_guard lock(folder().mutex);
    folder().path = path;
}

} // namespace relume
