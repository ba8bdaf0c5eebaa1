#include "render/context.h"

#include "souple/error.h"

#include <array>
#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <string_view>
#include <vector>

#include <fmt/core.h>

namespace souple::render {

namespace {

constexpr std::string_view remedy =
    "; pictures need EGL, OpenGL and a driver: install the Debian packages libegl1, libgles2, "
    "libegl-mesa0 and libgl1-mesa-dri (the last one draws without a GPU, too)";

[[noreturn]] void fail(const std::string& what) {
  throw Error(what + std::string(remedy));
}

// libepoxy ends the program when a library or a function is missing, so both are checked beforehand.
void require_library(const char* file, const char* what) {
  void* library = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr)
    fail(std::string("there is no ") + what + " on this machine (" + file + " cannot be loaded)");
  dlclose(library);
}

bool client_has(std::string_view extension) {
  const char* all = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return all != nullptr && std::string_view(all).find(extension) != std::string_view::npos;
}

// Displays to try, best first: one for each hardware device, then Mesa's surfaceless platform (a GPU if Mesa
// has a driver for one, else llvmpipe).
std::vector<EGLDisplay> displays() {
  std::vector<EGLDisplay> found;
  if (!client_has("EGL_EXT_platform_base")) return found;
  if (client_has("EGL_EXT_platform_device") && client_has("EGL_EXT_device_enumeration")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(EGLint(devices.size()), devices.data(), &count) == EGL_TRUE) {
      for (EGLint i = 0; i < count; ++i) {
        const char* extensions = eglQueryDeviceStringEXT(devices.at(std::size_t(i)), EGL_EXTENSIONS);
        const bool software =
            extensions != nullptr && std::string_view(extensions).find("software") != std::string_view::npos;
        if (software) continue;  // llvmpipe; the surfaceless platform below finds it
        found.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices.at(std::size_t(i)), nullptr));
      }
    }
  }
  if (client_has("EGL_MESA_platform_surfaceless")) {
    found.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  return found;
}

EGLConfig any_config(EGLDisplay display, Api api) {
  const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                     api == Api::es3 ? EGL_OPENGL_ES3_BIT : EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display, wanted.data(), &config, 1, &count);
  return count > 0 ? config : nullptr;
}

EGLContext make_context(EGLDisplay display, Api api) {
  if (eglBindAPI(api == Api::es3 ? EGL_OPENGL_ES_API : EGL_OPENGL_API) != EGL_TRUE) return EGL_NO_CONTEXT;
  const bool es = api == Api::es3;
  std::vector<EGLint> wanted{EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, es ? 0 : 3};
  if (!es)
    wanted.insert(wanted.end(), {EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT});
  wanted.push_back(EGL_NONE);
  return eglCreateContext(display, any_config(display, api), EGL_NO_CONTEXT, wanted.data());
}

// Messages of the debug callback and of glGetError, per thread, since a context is current in one thread.
std::vector<std::string>& gl_messages() {
  thread_local std::vector<std::string> messages;
  return messages;
}

void GLAPIENTRY note_message(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum severity, GLsizei length,
                             const GLchar* text, const void* /*user*/) {
  if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
  gl_messages().emplace_back(text, length < 0 ? std::string_view(text).size() : std::size_t(length));
}

}  // namespace

struct OffscreenContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

OffscreenContext::OffscreenContext(Api api) : impl_(std::make_unique<Impl>()) {
  const char* name = api == Api::es3 ? "OpenGL ES 3.0" : "OpenGL 3.3";
  require_library("libEGL.so.1", "EGL");
  if (api == Api::es3) require_library("libGLESv2.so.2", "OpenGL ES");
  const std::vector<EGLDisplay> candidates = displays();
  if (candidates.empty()) fail("EGL finds no driver on this machine that can draw without a screen");
  for (EGLDisplay display : candidates) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE) continue;
    EGLContext context = make_context(display, api);
    if (context == EGL_NO_CONTEXT) continue;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
      eglDestroyContext(display, context);
      continue;
    }
    *impl_ = {display, context};
    return;
  }
  fail("EGL cannot create an " + std::string(name) + " context on this machine");
}

OffscreenContext::~OffscreenContext() {
  if (eglGetCurrentContext() == impl_->context) {
    eglMakeCurrent(impl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  // The display stays initialized: the whole program has one, and another context may use it.
  eglDestroyContext(impl_->display, impl_->context);
}

std::string context_description() {
  const auto text = [](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(glGetString(name));
    return std::string(value == nullptr ? "unknown" : value);
  };
  const std::string version = text(GL_VERSION);
  return (epoxy_is_desktop_gl() ? "OpenGL " + version : version) + ", " + text(GL_RENDERER);
}

bool draws_in_software() {
  const std::string renderer = context_description();
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"}) {
    if (renderer.find(name) != std::string::npos) return true;
  }
  return false;
}

void watch_gl_errors() {
  gl_messages().clear();
  if (!epoxy_has_gl_extension("GL_KHR_debug")) return;  // only glGetError is available
  if (epoxy_is_desktop_gl()) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(&note_message, nullptr);
  } else {
    glEnable(GL_DEBUG_OUTPUT_KHR);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS_KHR);
    glDebugMessageCallbackKHR(&note_message, nullptr);
  }
}

void throw_gl_errors() {
  std::vector<std::string>& messages = gl_messages();
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError()) {
    messages.push_back(fmt::format("glGetError returns {}", error));
  }
  if (messages.empty()) return;
  const std::string first = messages.front();
  messages.clear();
  throw Error("OpenGL: " + first);
}

}  // namespace souple::render
