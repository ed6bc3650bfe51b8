#include "renderer/gl/vertex_array.h"

namespace relume::gl {

VertexArray::VertexArray(const Desc& desc) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    handle_ = Handle<deleteVertexArray>(name);
    if (desc.vertices != nullptr) glVertexArrayVertexBuffer(name, 0, desc.vertices->get(), 0, desc.stride);
    if (desc.indices != nullptr) glVertexArrayElementBuffer(name, desc.indices->get());
    for (size_t i = 0; i < desc.attributes.size(); ++i) {
        const VertexAttribute& attribute = desc.attributes[i];
        const auto location = static_cast<GLuint>(i);
        glEnableVertexArrayAttrib(name, location);
        if (attribute.type == GL_UNSIGNED_INT)
            glVertexArrayAttribIFormat(name, location, attribute.components, attribute.type,
                                       attribute.offset);
        else
            glVertexArrayAttribFormat(name, location, attribute.components, attribute.type, GL_FALSE,
                                      attribute.offset);
        glVertexArrayAttribBinding(name, location, 0);
    }
    label(GL_VERTEX_ARRAY, name, desc.name);
}

} // namespace relume::gl
