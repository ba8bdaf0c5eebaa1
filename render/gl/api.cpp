#include "render/gl/api.h"

#ifdef __EMSCRIPTEN__
#include <emscripten/html5_webgl.h>
#endif

namespace souple::render::gl {

#ifdef __EMSCRIPTEN__

bool is_es() {
  return true;
}
int version() {
  return 30;
}
bool has_extension(const std::string& name) {
  const std::string short_name = name.rfind("GL_", 0) == 0 ? name.substr(3) : name;
  return emscripten_webgl_enable_extension(emscripten_webgl_get_current_context(), short_name.c_str()) != 0;
}
bool can_wait_for_queries() {
  return false;
}

#else

bool is_es() {
  return !epoxy_is_desktop_gl();
}
int version() {
  return epoxy_gl_version();
}
bool has_extension(const std::string& name) {
  return epoxy_has_gl_extension(name.c_str());
}
bool can_wait_for_queries() {
  return true;
}

#endif

}  // namespace souple::render::gl
