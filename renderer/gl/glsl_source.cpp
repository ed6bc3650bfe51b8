#include "renderer/gl/glsl_source.h"

#include "assets/base/error.h"
#include "shaders/shader_library.h"

#include <algorithm>
#include <regex>
#include <sstream>

namespace relume::gl {
namespace {

// Returns the path in `#include "path"`, or "" where the line is no such line.
std::string includedPath(const std::string& line) {
    static const std::regex pattern("^[ \t]*#[ \t]*include[ \t]*\"([^\"]+)\".*$");
    std::smatch match;
    return std::regex_match(line, match, pattern) ? match[1].str() : "";
}

void append(GlslSource& source, const std::string& path) {
    const std::string text = shaderText(path);
    const size_t file = source.files.size();
    source.files.push_back(path);
    source.text += "#line 1 " + std::to_string(file) + "\n";
    std::istringstream lines(text);
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const std::string included = includedPath(line);
        if (included.empty()) {
            source.text += line + "\n";
            continue;
        }
        if (std::find(source.files.begin(), source.files.end(), included) == source.files.end())
            append(source, included);
        source.text += "#line " + std::to_string(number + 1) + " " + std::to_string(file) + "\n";
    }
}

} // namespace

GlslSource loadGlsl(const std::string& path, const std::vector<std::string>& definitions) {
    GlslSource source;
    // These make lib/*.glsl GLSL: in C++ FUNCTION is `inline`.
    source.text = "#version 450 core\n#define FUNCTION\n#define CONST const\n#define INOUT(T) inout T\n";
    for (std::string definition : definitions) {
        const size_t equals = definition.find('=');
        if (equals != std::string::npos) definition[equals] = ' ';
        source.text += "#define " + definition + "\n";
    }
    append(source, path);
    return source;
}

std::string describeLog(const GlslSource& source, const std::string& log) {
    // Mesa writes "0:12(5): error: text"; NVIDIA writes "0(12) : error C1008: text".
    static const std::regex mesa("^([0-9]+):([0-9]+)\\([0-9]+\\): error: (.*)$");
    static const std::regex nvidia("^([0-9]+)\\(([0-9]+)\\) : error (.*)$");
    std::istringstream lines(log);
    std::string first;
    for (std::string line; std::getline(lines, line);) {
        std::smatch match;
        if (first.empty()) first = line;
        if (!std::regex_match(line, match, mesa) && !std::regex_match(line, match, nvidia)) continue;
        const size_t file = std::stoul(match[1].str());
        const std::string name = file < source.files.size() ? source.files[file] : source.files.front();
        return name + ":" + match[2].str() + ": " + match[3].str();
    }
    return source.files.front() + ": " +
           (first.empty() ? "does not compile, the driver does not say why" : first);
}

} // namespace relume::gl
