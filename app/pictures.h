#pragma once

#include "app/picture_arguments.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/display.h"
#include "render/extreme_points.h"
#include "render/image.h"
#include "render/renderer.h"
#include "render/subject.h"
#include "souple/scene/scene.h"

#include <memory>
#include <string>

namespace souple::app {

struct PictureStyle {
  PictureSize size{1280, 720};
  int samples = 16;
  render::DisplayOptions display;
  render::LiquidFilter liquid_filter = render::LiquidFilter::narrow_range;
  int liquid_steps = 0;   ///< see RenderOptions
  float aperture = 0;     ///< see RenderOptions; 0: no depth of field [m]
  float focus = 0;        ///< 0: the distance of the camera's target [m]
  bool caustics = false;  ///< of all fluids
  /// Instead of the subject's sky; nullptr: none.
  std::shared_ptr<const render::Environment> sky;
  double exposure = 0;  ///< time during which the shutter is open; 0: no motion blur [s]

  float aspect() const { return static_cast<float>(size.width) / static_cast<float>(size.height); }
};

/// Extreme points of all objects, without colliders.
render::ExtremePoints extent_of(const render::Subject& subject);

/// Extreme points of all objects, and of colliders that are not much larger than the objects.
render::ExtremePoints extent_with_colliders(const render::Subject& subject);

/// Whether `camera_for` frames the extent: neither the request nor the scene places the camera.
bool is_automatic(const CameraRequest& request, const CameraDescription* scene);

/// The requested camera. Values that `request` leaves open come from `scene`. If the scene has no camera either (or a
/// run embeds no scene, nullptr), the points of `extent` are framed. The camera turns if they fill little of the
/// picture. Throws Error when the camera's position equals its target.
render::Camera camera_for(const CameraRequest& request, const CameraDescription* scene,
                          const render::ExtremePoints& extent, float aspect);

/// Renders pictures without window or screen.
class PictureMaker {
 public:
  /// Throws Error that names what the machine lacks.
  PictureMaker() = default;

  /// Draws `label` in the lower left corner. Equal subjects give equal pictures.
  render::Image picture(const render::Subject& subject, const render::Camera& camera,
                        const PictureStyle& style, const std::string& label = {});

 private:
  render::OffscreenContext context_;
  render::Renderer renderer_;
  render::SubjectDrawing drawing_;
};

}  // namespace souple::app
