#pragma once

#include "render/color.h"
#include "render/gl/texture.h"
#include "render/mat4.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple::render::gl {

inline void delete_program(GLuint id) {
  glDeleteProgram(id);
}

/// A vertex and a fragment shader. Their sources, in the GLSL of OpenGL ES 3.00 without `#version`, are in
/// render/shaders and built into the library. A source may `#include "other.glsl"`; each file is included
/// once. The uniform block `Frame` is bound to `frame_binding`; each sampler NAME_map to its Unit in
/// texture.h.
class Program {
 public:
  static constexpr GLuint frame_binding = 0;

  /// Names of files in render/shaders; each name in `defines` is #defined to 1. Throws Error with the
  /// shader's name and the compiler's message.
  Program(std::string_view vertex, std::string_view fragment, const std::vector<std::string>& defines = {});

  void use() const { glUseProgram(handle_.id()); }

  // Uniforms of this program, which must be in use. Names that the shaders do not use are ignored.
  void set(std::string_view name, int value) const;
  void set(std::string_view name, unsigned value) const;
  void set(std::string_view name, float value) const;
  void set(std::string_view name, float x, float y) const;
  void set(std::string_view name, const Vec3f& value) const;
  void set(std::string_view name, const Vec4& value) const;
  void set(std::string_view name, const Color& value) const;  ///< vec4
  void set(std::string_view name, const Mat4& value) const;

 private:
  GLint location(std::string_view name) const;
  void find_uniforms();

  Handle<delete_program> handle_;
  std::vector<std::pair<std::string, GLint>> uniforms_;
};

}  // namespace souple::render::gl
