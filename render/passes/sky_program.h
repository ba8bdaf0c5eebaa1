#pragma once

#include "render/environment.h"
#include "render/gl/program.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace souple::render {

/// A program with the shader sky.glsl: one for the procedural sky, and one for a panorama, compiled when it is needed.
class SkyProgram {
 public:
  explicit SkyProgram(std::string_view fragment, std::vector<std::string> defines = {})
      : fragment_(fragment), defines_(std::move(defines)), procedural_(vertex, fragment, defines_) {}

  const gl::Program& of(bool panorama) {
    if (!panorama) return procedural_;
    if (!panorama_) {
      std::vector<std::string> defines = defines_;
      defines.emplace_back("SKY_MAP");
      panorama_.emplace(vertex, fragment_, defines);
    }
    return *panorama_;
  }

 private:
  static constexpr std::string_view vertex = "ray.vert.glsl";
  std::string fragment_;
  std::vector<std::string> defines_;
  gl::Program procedural_;
  std::optional<gl::Program> panorama_;
};

/// The panorama on the GPU.
class SkyMap {
 public:
  /// Uploads it unless it is the last one, and binds it.
  void bind(const std::shared_ptr<const Environment>& environment);

 private:
  std::shared_ptr<const Environment> environment_;
  gl::Texture texture_;
};

}  // namespace souple::render
