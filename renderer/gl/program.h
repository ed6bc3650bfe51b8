#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "renderer/gl/handle.h"

namespace relume::gl {

inline void deleteProgram(GLuint name) {
    glDeleteProgram(name);
}

/// Owns a vertex and a fragment shader, linked; move-only. Uniforms are set by the locations their GLSL gives
/// them.
class Program {
public:
    struct Desc {
        std::string vertex, fragment;         // paths in shaders/, e.g. "gl/scene.vert"
        std::vector<std::string> definitions; // "NAME" or "NAME=VALUE"
        const char* name = "";
    };
    Program() = default;
    /// Throws Error when a source is missing or wrong: "gl/scene.frag:12: 'x' undeclared".
    explicit Program(const Desc& desc);

    void use() const { glUseProgram(get()); }
    void set(GLint location, GLuint value) const { glProgramUniform1ui(get(), location, value); }
    void set(GLint location, float value) const { glProgramUniform1f(get(), location, value); }
    void set(GLint location, const glm::vec2& value) const {
        glProgramUniform2fv(get(), location, 1, &value.x);
    }
    void set(GLint location, const glm::vec3& value) const {
        glProgramUniform3fv(get(), location, 1, &value.x);
    }
    void set(GLint location, const glm::vec4& value) const {
        glProgramUniform4fv(get(), location, 1, &value.x);
    }
    void set(GLint location, const glm::mat3& value) const {
        glProgramUniformMatrix3fv(get(), location, 1, GL_FALSE, &value[0].x);
    }
    void set(GLint location, const glm::mat4& value) const {
        glProgramUniformMatrix4fv(get(), location, 1, GL_FALSE, &value[0].x);
    }

    GLuint get() const { return handle_.get(); }

private:
    Handle<deleteProgram> handle_;
};

} // namespace relume::gl
