#pragma once

#include "render/camera.h"
#include "render/draw_list.h"
#include "render/image.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace souple::render {

/// Filter that turns the depth of a liquid's particles into a smooth surface.
enum class LiquidFilter {
  none,            ///< no smoothing: the balls themselves
  curvature_flow,  ///< van der Laan, Green, Sainz 2009
  narrow_range     ///< Truong, Yuksel 2018
};
inline constexpr std::size_t liquid_filter_count = 3;
std::string_view liquid_filter_name(LiquidFilter filter);
inline constexpr int max_liquid_steps = 500;

struct RenderOptions {
  bool labels = true;  ///< text of the list, such as legends
  bool shadows = true;
  bool ambient_occlusion = true;
  /// Number of averaged pictures, each with slight offsets of the pixel grid, the sun and the occlusion rays. Use 1 for
  /// a window, 16 and more for a still image without aliasing. Deterministic.
  int samples = 1;
  float exposure = 1;
  /// The filmic curve; without it pixels are linear up to radiance 1, for measurements.
  bool tone_curve = true;
  LiquidFilter liquid_filter = LiquidFilter::narrow_range;
  /// Steps of curvature flow, or passes of the narrow-range filter; 0: 40 or 2. The amount of smoothing does
  /// not depend on it, nor on the size of the picture: more steps are only more accurate.
  int liquid_steps = 0;
  /// For windows. The thickness of liquids is summed on a quarter of the picture's edges instead of half of them. The
  /// light through liquids uses a map of half the edge, because both are soft. Walls of glass are found on half of the
  /// picture's edges, those behind liquids are left out. Refracted rays take half as many steps, and soft shadows are
  /// filtered from 5 and 8 points, not 8 and 14.
  bool coarse = false;
  float aperture = 0;  ///< diameter of the camera's lens; 0: everything is sharp; needs many samples [m]
  float focus = 1;     ///< distance along the view at which points are sharp, above 0 [m]
};

/// Content of a picture while the shutter is open: at a time in [0, 1]. The list must be valid until the next call.
using ListAt = std::function<const DrawList&(float time)>;
inline constexpr int max_shutter_steps = 32;  ///< times at which a moving picture asks for a list

/// The object at a pixel.
struct Picked {
  std::uint32_t pick = 0;  ///< pick of the Surface, Spheres or Liquid; 0: none
  /// For spheres and liquids the index; for a surface the vertex nearest to the point.
  std::uint32_t element = 0;
  Vec3f point{};  ///< m
};

/// The pick buffer of a whole picture.
struct PickImage {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pick, element;  ///< as in Picked; width * height, rows from the top
  std::vector<float> depth;                  ///< along the view direction [m]; 0 where there is no object
};

/// The surface of all liquids as it is shaded, and their thickness.
struct LiquidImage {
  int width = 0, height = 0;
  /// Along the view direction [m]; 0 where there is no liquid; width * height, rows from the top; opaque
  /// objects in front are ignored.
  std::vector<float> depth;
  std::vector<float> thickness;  ///< along the ray through each pixel; opaque objects are ignored [m]
};

/// The color of a framebuffer of this size; 0 is the window's.
Image read_framebuffer(std::uint32_t framebuffer, int width, int height);

/// Draws lists with the OpenGL context that was current at construction; it must be current for every use.
/// Requires OpenGL ES 3.0 with EXT_color_buffer_float (and EXT_float_blend for samples > 1).
class Renderer {
 public:
  /// Throws Error that names a feature the context lacks.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws into a framebuffer of this size (0 is the window's). Draws nothing when a side is 0.
  void draw(const DrawList& list, const Camera& camera, const RenderOptions& options, int width, int height,
            std::uint32_t framebuffer = 0);
  /// Draws the list's text into the current framebuffer and viewport of this size. The text is sharp, over a scene that
  /// was drawn with fewer pixels and without labels.
  void draw_labels(const DrawList& list, int width, int height);
  /// Draws into memory. Throws Error when the size is not in [1, 8192].
  Image picture(const DrawList& list, const Camera& camera, const RenderOptions& options, int width,
                int height);
  /// Picture of a moving list: samples are at equal steps of time. Labels are those of the last list.
  Image moving_picture(const ListAt& list_at, const Camera& camera, const RenderOptions& options, int width,
                       int height);

  /// The object under the pixel (x, y), counted from the top left.
  Picked pick(const DrawList& list, const Camera& camera, int x, int y, int width, int height);
  PickImage pick_image(const DrawList& list, const Camera& camera, int width, int height);

  /// With one sample.
  LiquidImage liquid_image(const DrawList& list, const Camera& camera, RenderOptions options, int width,
                           int height);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace souple::render
