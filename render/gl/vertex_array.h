#pragma once

#include "render/gl/buffer.h"

namespace souple::render::gl {

inline void delete_vertex_array(GLuint id) {
  glDeleteVertexArrays(1, &id);
}

/// Location of a vertex attribute in the elements of a buffer.
struct Attribute {
  GLuint location = 0;  ///< layout(location = ...) in the shader
  GLint components = 3;
  GLenum type = GL_FLOAT;  ///< if `integer`, integers are read as integers, else scaled to [0, 1]
  bool integer = false;
  GLsizei stride = 0;      ///< bytes; 0: packed
  std::size_t offset = 0;  ///< bytes
  GLuint divisor = 0;      ///< 1: one element per instance
};

/// The buffers that a draw call reads.
class VertexArray {
 public:
  VertexArray();

  void attribute(const Buffer& buffer, const Attribute& attribute);
  /// Disables an attribute: the shader reads zeros, or the value set by glVertexAttrib.
  void without_attribute(GLuint location);
  void elements(const Buffer& buffer);
  void bind() const { glBindVertexArray(id()); }
  GLuint id() const { return handle_.id(); }

 private:
  Handle<delete_vertex_array> handle_;
};

}  // namespace souple::render::gl
