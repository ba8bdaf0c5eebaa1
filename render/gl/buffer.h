#pragma once

#include "render/gl/handle.h"

#include <cstddef>
#include <span>

namespace souple::render::gl {

inline void delete_buffer(GLuint id) {
  glDeleteBuffers(1, &id);
}

/// A buffer of vertices, indices or uniforms.
class Buffer {
 public:
  Buffer();

  /// Replaces the content. The storage only grows.
  template <class T>
  void upload(std::span<const T> values) {
    upload_bytes(std::as_bytes(values));
  }
  template <class T>
  void upload_one(const T& value) {
    upload(std::span<const T>(&value, 1));
  }
  GLuint id() const { return handle_.id(); }

 private:
  void upload_bytes(std::span<const std::byte> bytes);

  Handle<delete_buffer> handle_;
  std::size_t capacity_ = 0;  // bytes
};

}  // namespace souple::render::gl
