#include "render/passes/shadow.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace souple::render {

namespace {

constexpr int map_side = 2048;  // pixels
// Pixels of the map of light through liquids and glass, which is soft.
constexpr int fine_light_side = 512, coarse_light_side = 256;

// Rounds up to one of 4 sizes per doubling: the texel size stays constant during small motions.
float stepped(float size) {
  return std::exp2(std::ceil(4 * std::log2(size)) / 4);
}

Vec3f moved(const Vec3f& to_sun, float x, float y) {
  const Vec3f side = normalized(cross(to_sun, std::abs(to_sun.y) < 0.9f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0}));
  return normalized(to_sun + side * x + cross(side, to_sun) * y);
}

}  // namespace

ShadowPass::ShadowPass()
    : map_(GL_DEPTH_COMPONENT32F, map_side, map_side), framebuffer_("the shadow map", {}, &map_) {}

void ShadowPass::resize_light(int side) {
  if (light_.width() == side) return;
  light_ = gl::Texture(GL_RGBA16F, side, side, GL_LINEAR);
  light_target_ = gl::Framebuffer("the light through liquids and glass", {&light_}, nullptr);
}

void ShadowPass::aim(Frame& frame, const Light& light, const Bounds& casters, float offset_x,
                     float offset_y) {
  const float tangent = std::tan(std::clamp(light.sun_size, 0.0f, 10.0f) * float(pi / 180));
  const Vec3f to_sun = moved(normalized(light.to_sun), tangent * offset_x, tangent * offset_y);
  frame.to_sun = {to_sun.x, to_sun.y, to_sun.z, frame.to_sun.w};
  frame.sun_size.x = tangent;
  frame.shadow_size.w = 0;
  const float radius = casters.radius();
  if (casters.empty() || !(radius > 0) || !std::isfinite(radius)) return;
  // A cube around the casters' bounding sphere, as seen from the sun. Its center is on whole texels, with a margin for
  // the sun's apparent size.
  const float half = stepped(radius * (1.02f + 4 * std::min(tangent, 0.25f))), texel = 2 * half / map_side;
  const Vec3f up = std::abs(to_sun.y) < 0.99f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0};
  view_ = look_at(Vec3f{}, -to_sun, up);
  const Vec3f middle = casters.center();
  const Vec4 seen = view_ * Vec4{middle.x, middle.y, middle.z, 1};
  const float x = std::round(seen.x / texel) * texel, y = std::round(seen.y / texel) * texel;
  projection_ = orthographic(x - half, x + half, y - half, y + half, -seen.z - half, -seen.z + half);
  frame.shadow = to_texture(projection_ * view_);
  frame.shadow_size = {2 * half, 0, texel, 1};
}

void ShadowPass::draw(const Frame& frame, SurfacesPass& surfaces, SpheresPass& spheres) {
  const Frame sun = frame_from_sun(frame, view_, projection_, map_side);
  bind_frame(frame_buffer_, sun);

  framebuffer_.bind();
  clear_depth(1);
  if (frame.shadow_size.w == 0) return;
  glEnable(GL_DEPTH_TEST);
  const PassContext context{map_side, map_side, Target::depth, sun.view, sun.projection, {}};
  surfaces.draw(context);
  spheres.draw(context);
}

void ShadowPass::draw_light(const LiquidSplats& liquids, SurfacesPass& surfaces, bool coarse) {
  const int side = coarse ? coarse_light_side : fine_light_side;
  resize_light(side);
  light_target_.bind();
  const std::array<float, 4> clear{0, 0, 0, 1};
  glClearBufferfv(GL_COLOR, 0, clear.data());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glBlendEquationSeparate(GL_FUNC_ADD, GL_MIN);
  liquids.draw(SplatTarget::sunlight);
  if (surfaces.glass_casts_shadow()) surfaces.draw({side, side, Target::sunlight, view_, projection_, {}});
  glBlendEquation(GL_FUNC_ADD);
  glDisable(GL_BLEND);
}

void ShadowPass::bind() const {
  map_.bind(gl::Unit::shadow);
  if (light_.width() > 0) light_.bind(gl::Unit::liquid_light);
}

}  // namespace souple::render
