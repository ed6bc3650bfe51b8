#include "renderer/gl/debug.h"

#include "assets/base/error.h"
#include "assets/base/log.h"

#include <atomic>
#include <string_view>

#include <epoxy/gl.h>

namespace relume::gl {
namespace {

std::atomic<uint32_t> messages{0};

void GLAPIENTRY receive(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* text,
                        const void*) {
    std::string_view message(text, static_cast<size_t>(length));
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
        message.remove_suffix(1);
    const bool broken = type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR;
    // Drivers tell about buffer placement and shader recompilation under "performance" and "other".
    const bool note = type == GL_DEBUG_TYPE_PERFORMANCE || type == GL_DEBUG_TYPE_OTHER ||
                      severity == GL_DEBUG_SEVERITY_NOTIFICATION;
    if (broken) {
        ++messages;
        spdlog::error("OpenGL: {}", message);
    } else if (note) {
        spdlog::debug("OpenGL: {}", message);
    } else {
        ++messages;
        spdlog::warn("OpenGL: {}", message);
    }
}

std::string textOf(GLenum name) {
    const auto* text = reinterpret_cast<const char*>(glGetString(name));
    return text != nullptr ? text : "unknown";
}

} // namespace

void listenToDebugMessages() {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(receive, nullptr);
    // Errors in a shader are thrown, with file and line.
    glDebugMessageControl(GL_DEBUG_SOURCE_SHADER_COMPILER, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_FALSE);
    // Labelled groups of passes would come back as messages.
    glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_PUSH_GROUP, GL_DONT_CARE, 0, nullptr, GL_FALSE);
    glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_POP_GROUP, GL_DONT_CARE, 0, nullptr, GL_FALSE);
}

uint32_t debugMessageCount() {
    return messages;
}

std::string describeContext() {
    const int version = epoxy_gl_version();
    return textOf(GL_RENDERER) + ", OpenGL " + std::to_string(version / 10) + "." +
           std::to_string(version % 10);
}

bool isSoftware() {
    const std::string renderer = textOf(GL_RENDERER);
    return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
}

void requireOpenGl45() {
    if (epoxy_gl_version() >= 45) return;
    throw Error(describeContext() +
                ": pictures need OpenGL 4.5: bring the graphics driver up to date or use Mesa's "
                "software one (LIBGL_ALWAYS_SOFTWARE=1); 'relume bake' needs none");
}

} // namespace relume::gl
