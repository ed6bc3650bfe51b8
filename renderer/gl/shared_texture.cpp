#include "renderer/gl/shared_texture.h"

#include "assets/base/error.h"
#include "renderer/gl/errors.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

namespace relume::gl {
namespace {

bool canImport() {
    return epoxy_has_gl_extension("GL_EXT_memory_object") &&
           epoxy_has_gl_extension("GL_EXT_memory_object_fd");
}

Error refusal(const SharedTexture::Desc& desc, const char* what) {
    return Error(fmt::format("OpenGL cannot share '{}' ({} x {}) with Vulkan ({}): use --display copied",
                             desc.name, desc.width, desc.height, what));
}

} // namespace

GlSharing querySharing() {
    GlSharing sharing;
    sharing.memoryObject = canImport();
    if (!sharing.memoryObject) return sharing;
    GLint count = 0;
    glGetIntegerv(GL_NUM_DEVICE_UUIDS_EXT, &count);
    sharing.deviceUuids.resize(static_cast<size_t>(count));
    for (size_t i = 0; i < sharing.deviceUuids.size(); ++i)
        glGetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, static_cast<GLuint>(i), sharing.deviceUuids[i].data());
    return sharing;
}

SharedTexture::SharedTexture(const Desc& desc) : width_(desc.width), height_(desc.height) {
    ASSERT(desc.width > 0 && desc.height > 0);
    if (!canImport()) {
        ::close(desc.fd);
        throw refusal(desc, "no GL_EXT_memory_object_fd");
    }
    GLuint memory = 0, texture = 0;
    clearErrors();
    glCreateMemoryObjectsEXT(1, &memory);
    memory_ = Handle<deleteMemoryObject>(memory);
    const GLint dedicated = GL_TRUE;
    glMemoryObjectParameterivEXT(memory, GL_DEDICATED_MEMORY_OBJECT_EXT, &dedicated);
    glImportMemoryFdEXT(memory, desc.memorySize, GL_HANDLE_TYPE_OPAQUE_FD_EXT, desc.fd);
    if (glGetError() != GL_NO_ERROR) {
        ::close(desc.fd); // only a successful import owns it
        throw refusal(desc, "the memory is refused");
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    texture_ = Handle<deleteTexture>(texture);
    glTextureParameteri(texture, GL_TEXTURE_TILING_EXT, GL_OPTIMAL_TILING_EXT);
    glTextureStorageMem2DEXT(texture, 1, desc.format, static_cast<GLsizei>(desc.width),
                             static_cast<GLsizei>(desc.height), memory, 0);
    // Some drivers take any descriptor and notice only now that there is no memory behind it.
    if (glGetError() != GL_NO_ERROR) throw refusal(desc, "no texture fits the memory");
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    label(GL_TEXTURE, texture, desc.name);
}

} // namespace relume::gl
