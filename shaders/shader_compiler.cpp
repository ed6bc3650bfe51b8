#include "shaders/shader_compiler.h"

#include "assets/base/error.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>

namespace relume {

namespace {

// glslang keeps tables for the whole process; they are freed at its end so that leak checkers stay quiet.
struct GlslangProcess {
    GlslangProcess() { glslang::InitializeProcess(); }
    ~GlslangProcess() { glslang::FinalizeProcess(); }
};

EShLanguage stageOf(const std::string& name) {
    static const std::array<std::pair<const char*, EShLanguage>, 8> stages = {{{".vert", EShLangVertex},
                                                                               {".frag", EShLangFragment},
                                                                               {".comp", EShLangCompute},
                                                                               {".rgen", EShLangRayGen},
                                                                               {".rchit", EShLangClosestHit},
                                                                               {".rahit", EShLangAnyHit},
                                                                               {".rmiss", EShLangMiss},
                                                                               {".geom", EShLangGeometry}}};
    const std::string extension = std::filesystem::path(name).extension().string();
    for (const auto& [ending, stage] : stages)
        if (extension == ending) return stage;
    throw Error(name + ": '" + extension +
                "' names no shader stage: end it in .comp, .vert, .frag, .rgen, ...");
}

// Finds includes by the rules of glslangValidator -I: first beside the including file, then in the shader
// folder.
class FolderIncluder final : public glslang::TShader::Includer {
public:
    explicit FolderIncluder(std::filesystem::path folder) : folder_(std::move(folder)) {}

    IncludeResult* includeLocal(const char* header, const char* includer, size_t) override {
        if (IncludeResult* result = open(std::filesystem::path(includer).parent_path() / header))
            return result;
        return open(folder_ / header);
    }
    IncludeResult* includeSystem(const char* header, const char*, size_t) override {
        return open(folder_ / header);
    }

    void releaseInclude(IncludeResult* result) override {
        if (result == nullptr) return;
        delete static_cast<std::string*>(result->userData);
        delete result;
    }

private:
    static IncludeResult* open(const std::filesystem::path& path) {
        std::ifstream file(path, std::ios::binary);
        if (!file || std::filesystem::is_directory(path)) return nullptr;
        auto text = std::make_unique<std::string>(std::istreambuf_iterator<char>(file),
                                                  std::istreambuf_iterator<char>());
        auto* result = new IncludeResult(path.string(), text->data(), text->size(), text.get());
        text.release(); // from here on releaseInclude frees it
        return result;
    }

    std::filesystem::path folder_;
};

// Returns the first error, which is the one to mend: glslang prints one line per error and a summary.
std::string firstError(const std::string& name, const std::string& log) {
    std::istringstream lines(log);
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("ERROR: ", 0) != 0) continue;
        line.erase(0, 7);
        while (!line.empty() && (line.back() == ' ' || line.back() == '\r'))
            line.pop_back();
        return line.rfind(name, 0) == 0 || line.find(':') != std::string::npos ? line : name + ": " + line;
    }
    return name + ": the shader does not compile";
}

} // namespace

std::vector<uint32_t> compileShader(const ShaderSource& source) {
    const EShLanguage stage = stageOf(source.name);
    static std::mutex mutex; // glslang's set-up is per process
    const std::lock_guard lock(mutex);
    static const GlslangProcess process;

    std::string preamble = "#define FUNCTION\n";
    for (std::string definition : source.definitions) {
        const size_t equals = definition.find('=');
        if (equals != std::string::npos) definition[equals] = ' ';
        preamble += "#define " + definition + "\n";
    }

    glslang::TShader shader(stage);
    const char* text = source.text.c_str();
    const int length = static_cast<int>(source.text.size());
    const char* name = source.name.c_str();
    shader.setStringsWithLengthsAndNames(&text, &length, &name, 1);
    shader.setPreamble(preamble.c_str());
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);

    const auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
    FolderIncluder includer(source.includeFolder);
    if (!shader.parse(GetDefaultResources(), 110, false, messages, includer))
        throw Error(firstError(source.name, shader.getInfoLog()));
    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(messages)) throw Error(firstError(source.name, program.getInfoLog()));

    std::vector<uint32_t> code;
    glslang::GlslangToSpv(*program.getIntermediate(stage), code);
    return code;
}

} // namespace relume
