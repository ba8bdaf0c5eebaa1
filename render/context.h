#pragma once

#include <memory>
#include <string>

namespace souple::render {

enum class Api { es3, gl33 };

/// An OpenGL context without window, X server or screen, through EGL: a GPU where there is one, else Mesa's
/// llvmpipe. Current in the thread that made it, until it is destroyed.
class OffscreenContext {
 public:
  /// Throws Error that says what is missing and which package brings it.
  explicit OffscreenContext(Api api = Api::es3);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "OpenGL ES 3.2, llvmpipe (LLVM 15.0.6, 256 bits)" of the current context.
std::string context_description();
/// Whether the processor draws for lack of a graphics card: every pixel is dear then.
bool draws_in_software();

/// From now on every OpenGL error and high-severity message of the current context is counted (and thrown by
/// `throw_gl_errors`); for tests, and for the viewer's --debug.
void watch_gl_errors();
/// Throws Error with the first message since the last call, if there was one.
void throw_gl_errors();

}  // namespace souple::render
