#include "render/passes/pass_context.h"

#include <array>

namespace souple::render {

std::string target_define(Target target) {
  switch (target) {
    case Target::material:
      return "TARGET_MATERIAL";
    case Target::glass_entry:
      return "TARGET_GLASS_ENTRY";
    case Target::glass_exit:
      return "TARGET_GLASS_EXIT";
    case Target::sunlight:
      return "TARGET_SUNLIGHT";
    case Target::depth:
      return "TARGET_DEPTH";
    case Target::pick:
      return "TARGET_PICK";
  }
  return {};
}

Frame frame_from_sun(const Frame& frame, const Mat4& view, const Mat4& projection, int side) {
  Frame sun = frame;
  sun.view = view;
  sun.projection = projection;
  sun.inverse_view = inverse(view);
  sun.inverse_projection = inverse(projection);
  const auto pixels = float(side);
  sun.size = {pixels, pixels, 1 / pixels, 1 / pixels};
  sun.eye = {frame.to_sun.x, frame.to_sun.y, frame.to_sun.z, 0};
  return sun;
}

void bind_frame(gl::Buffer& buffer, const Frame& frame) {
  buffer.upload_one(frame);
  glBindBufferBase(GL_UNIFORM_BUFFER, gl::Program::frame_binding, buffer.id());
}

void clear_color(GLint attachment) {
  const std::array<float, 4> zero{};
  glClearBufferfv(GL_COLOR, attachment, zero.data());
}

void clear_depth(float depth) {
  glClearBufferfv(GL_DEPTH, 0, &depth);
}

void draw_screen() {
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace souple::render
