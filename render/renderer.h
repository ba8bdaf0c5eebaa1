#pragma once

#include "render/camera.h"
#include "render/draw_list.h"
#include "render/image.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace souple::render {

/// How the depth of a liquid's particles becomes a smooth surface.
enum class LiquidFilter {
  none,            ///< the balls themselves
  curvature_flow,  ///< van der Laan, Green, Sainz 2009
  narrow_range     ///< Truong, Yuksel 2018
};
inline constexpr std::size_t liquid_filter_count = 3;
std::string_view liquid_filter_name(LiquidFilter filter);
/// Throws Error that lists the names.
LiquidFilter liquid_filter_of(std::string_view name);
inline constexpr int most_liquid_steps = 500;

struct RenderOptions {
  bool shadows = true;
  bool ambient_occlusion = true;
  /// Pictures averaged, each with the pixel grid, the sun and the occlusion rays moved a little: 1 for a
  /// window, 16 and more for a still without jaggies. Deterministic.
  int samples = 1;
  float exposure = 1;
  LiquidFilter liquid_filter = LiquidFilter::narrow_range;
  /// Of curvature flow, or passes of the narrow-range filter; 0: 40 or 2. How far the surface is smoothed
  /// does not depend on it, nor on the size of the picture: more only makes it more exact.
  int liquid_steps = 0;
};

struct PassTime {
  std::string pass;
  double seconds = 0;
};

/// What lies under a pixel.
struct Picked {
  std::uint32_t pick = 0;  ///< of the Surface, Spheres or Liquid; 0: nothing
  /// Of spheres and liquids: which; of a surface: the vertex nearest to the point.
  std::uint32_t element = 0;
  Vec3f point{};  ///< m
};

/// The pick buffer of a whole picture.
struct PickImage {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pick, element;  ///< as of Picked; width * height, rows from the top
  std::vector<float> depth;                  ///< along the view direction [m]; 0 where nothing is
};

/// The surface of all liquids as it is shaded, and how thick they are.
struct LiquidImage {
  int width = 0, height = 0;
  std::vector<float> depth;      ///< along the view direction [m]; 0 where nothing is; width * height, rows
                                 ///< from the top; opaque objects before it are ignored
  std::vector<float> thickness;  ///< along the ray through each pixel; opaque objects are ignored [m]
};

/// Draws lists with the OpenGL context that was current when it was made, which has to be current whenever it
/// is used. Uses what OpenGL ES 3.0 has, with EXT_color_buffer_float (and EXT_float_blend for samples > 1).
class Renderer {
 public:
  /// Throws Error, saying which, when the context lacks something.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Into a framebuffer of this size (0 is the window's). Nothing is drawn when a side is 0.
  void draw(const DrawList& list, const Camera& camera, const RenderOptions& options, int width, int height,
            std::uint32_t framebuffer = 0);
  /// The same, into memory. Throws Error when the size is not in [1, 8192].
  Image picture(const DrawList& list, const Camera& camera, const RenderOptions& options, int width,
                int height);

  /// Draws off-screen and says how long each pass took, all of its samples together. OpenGL finishes all work
  /// after each, so the sum is a little more than a picture takes.
  std::vector<PassTime> measure(const DrawList& list, const Camera& camera, const RenderOptions& options,
                                int width, int height);

  /// Under the pixel (x, y), counted from the top left.
  Picked pick(const DrawList& list, const Camera& camera, int x, int y, int width, int height);
  PickImage pick_image(const DrawList& list, const Camera& camera, int width, int height);

  /// Of one sample.
  LiquidImage liquid_image(const DrawList& list, const Camera& camera, RenderOptions options, int width,
                           int height);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
