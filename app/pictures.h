#pragma once

#include "app/picture_words.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/display.h"
#include "render/image.h"
#include "render/renderer.h"
#include "render/subject.h"
#include "souple/scene/scene.h"

#include <string>

namespace souple::app {

struct PictureStyle {
  PictureSize size{1280, 720};
  int samples = 16;
  render::DisplayOptions display;
  render::LiquidFilter liquid_filter = render::LiquidFilter::narrow_range;
  int liquid_steps = 0;  ///< as of RenderOptions

  float aspect() const { return static_cast<float>(size.width) / static_cast<float>(size.height); }
};

/// The smallest box around all objects; colliders do not count.
render::Bounds bounds_of(const render::Subject& subject);

/// The camera that is meant: what the wish leaves open comes from `scene`; where the scene (or a run of no
/// scene, nullptr) says nothing either, the objects as they are in `subject` fill the picture. Throws Error
/// when it would stand where it looks.
render::Camera camera_for(const CameraWish& wish, const CameraDescription* scene,
                          const render::Subject& subject, float aspect);

/// Pictures without window or screen.
class PictureMaker {
 public:
  /// Throws Error that says what the machine lacks.
  PictureMaker() = default;

  /// `label` is written into the lower left corner. The same subject gives the same picture.
  render::Image picture(const render::Subject& subject, const render::Camera& camera,
                        const PictureStyle& style, const std::string& label = {});

 private:
  render::OffscreenContext context_;
  render::Renderer renderer_;
  render::SubjectDrawing drawing_;
};

}  // namespace souple::app
