#include "renderer/gl/program.h"

#include "assets/base/error.h"
#include "renderer/gl/glsl_source.h"

namespace relume::gl {
namespace {

void deleteShader(GLuint name) {
    glDeleteShader(name);
}

using Shader = Handle<deleteShader>;

template<typename Get, typename GetLog>
std::string infoLog(GLuint object, Get get, GetLog getLog) {
    GLint length = 0;
    get(object, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(length), '\0');
    GLsizei written = 0;
    if (length > 0) getLog(object, length, &written, log.data());
    log.resize(static_cast<size_t>(written));
    return log;
}

Shader compile(GLenum stage, const std::string& path, const std::vector<std::string>& definitions) {
    const GlslSource source = loadGlsl(path, definitions);
    Shader shader(glCreateShader(stage));
    const char* text = source.text.c_str();
    glShaderSource(shader.get(), 1, &text, nullptr);
    glCompileShader(shader.get());
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_TRUE)
        throw Error(describeLog(source, infoLog(shader.get(), glGetShaderiv, glGetShaderInfoLog)));
    return shader;
}

} // namespace

Program::Program(const Desc& desc) {
    const Shader vertex = compile(GL_VERTEX_SHADER, desc.vertex, desc.definitions);
    const Shader fragment = compile(GL_FRAGMENT_SHADER, desc.fragment, desc.definitions);
    handle_ = Handle<deleteProgram>(glCreateProgram());
    glAttachShader(get(), vertex.get());
    glAttachShader(get(), fragment.get());
    glLinkProgram(get());
    GLint linked = GL_FALSE;
    glGetProgramiv(get(), GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        std::string log = infoLog(get(), glGetProgramiv, glGetProgramInfoLog);
        log = log.substr(0, log.find('\n'));
        throw Error(desc.vertex + " and " + desc.fragment + " do not go together: " + log);
    }
    glDetachShader(get(), vertex.get());
    glDetachShader(get(), fragment.get());
    label(GL_PROGRAM, get(), desc.name);
}

} // namespace relume::gl
