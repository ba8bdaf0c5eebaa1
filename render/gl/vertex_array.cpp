#include "render/gl/vertex_array.h"

namespace souple::render::gl {

VertexArray::VertexArray() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  handle_ = Handle<delete_vertex_array>(id);
}

void VertexArray::attribute(const Buffer& buffer, const Attribute& attribute) {
  bind();
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  // OpenGL takes the offset as a pointer.
  const auto* offset = reinterpret_cast<const void*>(attribute.offset);  // NOLINT(performance-no-int-to-ptr)
  glEnableVertexAttribArray(attribute.location);
  if (attribute.integer) {
    glVertexAttribIPointer(attribute.location, attribute.components, attribute.type, attribute.stride,
                           offset);
  } else {
    const GLboolean scaled = attribute.type == GL_FLOAT ? GL_FALSE : GL_TRUE;
    glVertexAttribPointer(attribute.location, attribute.components, attribute.type, scaled, attribute.stride,
                          offset);
  }
  glVertexAttribDivisor(attribute.location, attribute.divisor);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  glBindVertexArray(0);
}

void VertexArray::without_attribute(GLuint location) {
  bind();
  glDisableVertexAttribArray(location);
  glBindVertexArray(0);
}

void VertexArray::elements(const Buffer& buffer) {
  bind();
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer.id());
  glBindVertexArray(0);
}

}  // namespace souple::render::gl
