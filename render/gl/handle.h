#pragma once

#include "render/gl/api.h"

#include <utility>

namespace souple::render::gl {

/// Owns one OpenGL object, which `Delete` releases. The context that created it must be current whenever it
/// is used or destroyed; this holds for all of gl/.
template <void (*Delete)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint id) : id_(id) {}
  ~Handle() {
    if (id_ != 0) Delete(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

}  // namespace souple::render::gl
