#pragma once

#ifdef __EMSCRIPTEN__
#include <GLES3/gl3.h>
#define GL_PROGRAM_POINT_SIZE 0x8642  // of desktop OpenGL; named where is_es() is false
#else
#include <epoxy/gl.h>
#endif

#include <string>

namespace souple::render::gl {

/// Whether the current context is OpenGL ES or WebGL, not desktop OpenGL.
bool is_es();
/// Version of the current context, 30 for 3.0. WebGL 2 counts as OpenGL ES 3.0.
int version();
/// Whether the current context has an extension, such as "GL_EXT_float_blend". In WebGL this enables the extension.
bool has_extension(const std::string& name);
/// Whether glGetQueryObjectuiv waits for a result. In WebGL a result arrives after the end of the frame's function.
bool can_wait_for_queries();

}  // namespace souple::render::gl
