#pragma once

#include <memory>
#include <string>

namespace souple::render {

enum class Api { es3, gl33 };

/// An OpenGL context through EGL, without window, X server or screen: on a GPU if there is one, else Mesa's
/// llvmpipe. It is current in the creating thread until its destruction.
class OffscreenContext {
 public:
  /// Throws Error that names the missing library and its package.
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
/// Whether the CPU renders because there is no GPU: pixels are expensive then.
bool draws_in_software();

/// Starts to record OpenGL errors and high-severity messages of the current context for `throw_gl_errors`;
/// for tests, and for the viewer's --debug.
void watch_gl_errors();
/// Throws Error with the first message since the last call, if any.
void throw_gl_errors();

}  // namespace souple::render
