#include "render/gl/texture.h"

namespace souple::render::gl {

namespace {

/// Levels of half the size each, of the bound texture, which repeats along its width.
void fill_levels() {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 1000);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glGenerateMipmap(GL_TEXTURE_2D);
}

}  // namespace

int largest_texture() {
  GLint side = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
  return side;
}

Texture::Texture(GLenum internal_format, int width, int height, GLenum filter)
    : width_(width), height_(height) {
  GLuint id = 0;
  glGenTextures(1, &id);
  handle_ = Handle<delete_texture>(id);
  glBindTexture(GL_TEXTURE_2D, id);
  // OpenGL 3.3 has no glTexStorage2D. The format must match the internal format, although there is no data.
  GLenum format = GL_RGBA, type = GL_UNSIGNED_BYTE;
  switch (internal_format) {
    case GL_R8:
      format = GL_RED;
      break;
    case GL_RG8:
      format = GL_RG;
      break;
    case GL_RG16F:
      format = GL_RG, type = GL_FLOAT;
      break;
    case GL_RG32UI:
      format = GL_RG_INTEGER, type = GL_UNSIGNED_INT;
      break;
    case GL_RGBA32UI:
      format = GL_RGBA_INTEGER, type = GL_UNSIGNED_INT;
      break;
    case GL_RGBA16F:
    case GL_RGBA32F:
      type = GL_FLOAT;
      break;
    case GL_R16F:
    case GL_R32F:
      format = GL_RED, type = GL_FLOAT;
      break;
    case GL_DEPTH_COMPONENT24:
      format = GL_DEPTH_COMPONENT, type = GL_UNSIGNED_INT;
      break;
    case GL_DEPTH_COMPONENT32F:
      format = GL_DEPTH_COMPONENT, type = GL_FLOAT;
      break;
    default:
      break;
  }
  glTexImage2D(GL_TEXTURE_2D, 0, GLint(internal_format), width, height, 0, format, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GLint(filter));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GLint(filter));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
}

Texture Texture::picture(int width, int height, const unsigned char* pixels) {
  Texture texture(GL_SRGB8_ALPHA8, width, height, GL_LINEAR);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
  fill_levels();
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

Texture Texture::panorama(int width, int height, const float* texels) {
  Texture texture(GL_RGBA16F, width, height, GL_LINEAR);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, texels);
  fill_levels();
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

void Texture::upload_bytes(const unsigned char* values) const {
  glBindTexture(GL_TEXTURE_2D, id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RED, GL_UNSIGNED_BYTE, values);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glBindTexture(GL_TEXTURE_2D, 0);
}

void Texture::bind(Unit unit) const {
  glActiveTexture(GL_TEXTURE0 + GLuint(unit));
  glBindTexture(GL_TEXTURE_2D, id());
}

}  // namespace souple::render::gl
