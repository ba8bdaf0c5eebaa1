#pragma once

#include <memory>
#include <string>

namespace souple::render {

enum class Api { es3, gl33 };

/// An OpenGL context without window, X server or screen, through EGL: on a GPU if there is one, else on
/// Mesa's llvmpipe. It is current in the thread that created it until it is destroyed.
class OffscreenContext {
 public:
  /// Throws Error that names what is missing and the package that provides it.
  explicit OffscreenContext(Api api = Api::es3);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "OpenGL ES 3.2, llvmpipe (LLVM 15.0.6, 256 bits)" for the current context.
std::string context_description();
/// Whether the processor renders for lack of a graphics card: then every pixel is costly.
bool draws_in_software();

/// From now on, every OpenGL error and high-severity message of the current context is recorded, for
/// `throw_gl_errors`. For tests, and for the viewer's --debug.
void watch_gl_errors();
/// Throws Error with the first message recorded since the last call, if there is one.
void throw_gl_errors();

}  // namespace souple::render
