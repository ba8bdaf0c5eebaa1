#pragma once

#include "render/camera.h"
#include "render/draw_list.h"
#include "render/gl/buffer.h"
#include "render/gl/program.h"
#include "render/mat4.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

// How a picture is made, once per sample:
//   shadow     casters from the sun                              -> depth           (target depth)
//   material   surfaces, spheres, ground                         -> albedo, normal, depth  (target material)
//   occlusion  how much sky each pixel sees, from normal, depth
//   lighting   one full-screen shader lights each pixel, with shadows and occlusion, and
//              tone-maps it                                      -> color (linear)
//   liquids    over that color, if there are any: the depth of their particles, smoothed; their thickness;
//              shading with the image behind (see liquid.h; their shadow is drawn after the other shadows)
//   glass      over that color, in layers from the farthest to the nearest (see glass.h); what is behind the
//              surface of liquids before their shading, the rest after it
//   lines      over that color, hidden by that depth
// Finally the samples' mean (or, for one sample, the color with smoothed edges) is sRGB-encoded into the
// caller's framebuffer, and labels are drawn over it. A pass that draws geometry has one fragment
// shader for all targets, compiled with a #define for each.

namespace souple::render {

/// Render targets.
enum class Target {
  material,     ///< TARGET_MATERIAL: write_material() of material.glsl
  glass_entry,  ///< TARGET_GLASS_ENTRY: where rays enter glass, see glass.h
  glass_exit,   ///< TARGET_GLASS_EXIT: where they leave it
  sunlight,     ///< TARGET_SUNLIGHT: sunlight lost in glass, seen from the sun
  depth,        ///< TARGET_DEPTH: depth only, seen from the sun
  pick          ///< TARGET_PICK: layout(location = 0) out uvec2 of pick and element
};
inline constexpr int target_count = 6;
std::string target_define(Target target);

/// The uniform block of frame.glsl (std140), shared by all shaders of a pass: the renderer binds it before
/// the pass. The eye may be the sun and the projection orthographic: then projection.m[15] is 1.
struct Frame {
  Mat4 view, projection;    ///< world -> view -> clip
  Mat4 inverse_view;        ///< view -> world
  Mat4 inverse_projection;  ///< clip -> view
  Mat4 shadow;              ///< world -> (x, y, depth), each in [0, 1], of the shadow map
  Vec4 eye;                 ///< world; w: 1
  Vec4 size;                ///< width, height, 1 / width, 1 / height [pixels]
  Vec4 to_sun;              ///< unit; w: irradiance times exposure
  /// Radiance of zenith, horizon and floor, times exposure. w, with a panorama: factor of its radiance, its rotation
  /// [turns], 1: it is drawn behind the scene.
  Vec4 sky, horizon, floor_light;
  Vec4 shadow_size;  ///< edge of the cube that the map covers [m], 0, width of a texel [m], 1: on
  Vec4
      sun_size;  ///< tangent of the sun's apparent radius; fraction of the softness that is blurred; 1: tone curve on;
                 ///< 1: shadows are filtered from fewer points
  Vec4 ground;  ///< height, edge of a tile [m], 1: shown, distance at which haze hides it [m]
  Vec4 ground_color, ground_second;
  Vec4 sample_info;  ///< index, count, a number in [0, 1) that differs between samples, 1: occlusion on
  Vec4 occlusion;    ///< radius [m], strength
  std::array<Vec4, 9> irradiance;  ///< of sky and floor, see sky.h; times exposure
};

/// Arguments of passes, in addition to the uniform block.
struct PassContext {
  int width = 0, height = 0;  ///< size of the render target
  Target target = Target::material;
  Mat4 view, projection;  ///< as in Frame
  Vec3f eye{};
  int layer = 0;         ///< targets of glass: number of layers drawn before
  float glass_part = 0;  ///< targets of glass: GlassPart
  int glass_scale = 1;   ///< targets of glass: pixels of the picture per pixel along an edge
};

/// The uniform block for the sun as the eye, which draws `side` x `side` pixels.
Frame frame_from_sun(const Frame& frame, const Mat4& view, const Mat4& projection, int side);
/// Uploads the uniform block and binds it.
void bind_frame(gl::Buffer& buffer, const Frame& frame);
/// Fill an attachment of the bound framebuffer: with zeros, with a depth.
void clear_color(GLint attachment);
void clear_depth(float depth);
/// Draws a triangle that covers the screen; the vertex shader is screen.vert.glsl.
void draw_screen();

}  // namespace souple::render
