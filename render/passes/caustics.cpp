#include "render/passes/caustics.h"

#include <cmath>

namespace souple::render {

namespace {

constexpr int side = 512;     // rays and pixels along an edge of the map
constexpr float room = 1.1f;  // width of the map, in those of the bounding sphere
/// Smoothing, in that of the visible surface: rays over some depth show slopes that the eye does not see.
constexpr float smoother = 2;

/// The sun as an eye, above a sphere around the bounds.
Frame sun_frame(const Frame& frame, const Bounds& bounds) {
  const Vec3f to_sun{frame.to_sun.x, frame.to_sun.y, frame.to_sun.z}, middle = bounds.center();
  const float half = room * bounds.radius();
  const Vec3f up = std::abs(to_sun.y) < 0.99f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0};
  return frame_from_sun(frame, look_at(middle + to_sun * half, middle, up),
                        orthographic(-half, half, -half, half, 0, 2 * half), side);
}

}  // namespace

CausticsPass::CausticsPass()
    : light_(GL_R16F, side, side, GL_LINEAR), target_("the light that liquids refract", {&light_}, nullptr) {}

void CausticsPass::draw(const Frame& frame, const LiquidSplats& splats, const Bounds& bounds, float height,
                        const gl::VertexArray& empty_array) {
  const Frame sun = sun_frame(frame, bounds);
  bind_frame(frame_buffer_, sun);
  to_map_ = to_texture(sun.projection * sun.view);
  floor_ = {height, 0.01f * bounds.radius(), 0, 0};
  surface_.find_depth(splats, side, {}, smoother, empty_array);

  target_.bind();
  clear_color(0);
  surface_.bind_surface();
  surface_.bind_look();
  rays_.use();
  rays_.set("height", height);
  empty_array.bind();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  if (!gl::is_es()) glEnable(GL_PROGRAM_POINT_SIZE);
  glDrawArrays(GL_POINTS, 0, side * side);
  if (!gl::is_es()) glDisable(GL_PROGRAM_POINT_SIZE);
  glDisable(GL_BLEND);
}

void CausticsPass::bind(const gl::Program& program) const {
  light_.bind(gl::Unit::sum);
  program.set("to_caustics", to_map_);
  program.set("caustics_floor", floor_);
}

}  // namespace souple::render
