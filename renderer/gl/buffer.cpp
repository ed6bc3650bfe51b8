#include "renderer/gl/buffer.h"

#include "renderer/gl/errors.h"

#include <string>

namespace relume::gl {

Buffer::Buffer(const Desc& desc) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    handle_ = Handle<deleteBuffer>(name);
    clearErrors();
    glNamedBufferStorage(name, desc.size, desc.data, desc.flags);
    checkMemory(std::string("buffer '") + desc.name + "'", static_cast<double>(desc.size));
    label(GL_BUFFER, name, desc.name);
}

} // namespace relume::gl
