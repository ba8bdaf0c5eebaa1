#pragma once

#include "render/gl/handle.h"

namespace souple::render::gl {

inline void delete_texture(GLuint id) {
  glDeleteTextures(1, &id);
}

/// Texture units of the samplers: `shadow_map` reads unit `shadow`, and so on.
enum class Unit : GLuint {
  shadow,
  sum,
  occlusion,
  albedo,
  normal,
  depth,
  color,
  glyph,
  pick,
  liquid_depth,
  liquid_look,
  liquid_optics,
  liquid_glow,
  liquid_light,
  print,
  sky
};

/// Edge of the largest texture of this context [pixels].
int largest_texture();

/// A texture of one level, clamped to its edge, read without interpolation unless `filter` requests it.
class Texture {
 public:
  Texture() = default;
  /// `internal_format` is a sized format: GL_RGBA8, GL_RGBA16F, GL_RGBA32F, GL_R8, GL_RG32UI,
  /// GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT32F, ...
  Texture(GLenum internal_format, int width, int height, GLenum filter = GL_NEAREST);

  /// A picture of sRGB-encoded R, G, B, A bytes with levels of half the size each, repeated beyond its edges.
  static Texture picture(int width, int height, const unsigned char* pixels);

  /// Four floats a texel, stored as 16 bits, with levels of half the size each, repeated along the width.
  static Texture panorama(int width, int height, const float* texels);

  /// Fills a GL_R8 texture of this size; rows are consecutive without padding.
  void upload_bytes(const unsigned char* values) const;
  void bind(Unit unit) const;
  GLuint id() const { return handle_.id(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Handle<delete_texture> handle_;
  int width_ = 0, height_ = 0;
};

}  // namespace souple::render::gl
