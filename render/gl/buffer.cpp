#include "render/gl/buffer.h"

namespace souple::render::gl {

Buffer::Buffer() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  handle_ = Handle<delete_buffer>(id);
}

void Buffer::upload_bytes(std::span<const std::byte> bytes) {
  // A binding point that is not part of a vertex array's state.
  glBindBuffer(GL_COPY_WRITE_BUFFER, id());
  if (bytes.size() > capacity_) {
    glBufferData(GL_COPY_WRITE_BUFFER, GLsizeiptr(bytes.size()), bytes.data(), GL_DYNAMIC_DRAW);
    capacity_ = bytes.size();
  } else if (!bytes.empty()) {
    glBufferSubData(GL_COPY_WRITE_BUFFER, 0, GLsizeiptr(bytes.size()), bytes.data());
  }
  glBindBuffer(GL_COPY_WRITE_BUFFER, 0);
}

}  // namespace souple::render::gl
