#include "app/last_picture.h"

#include "app/out_of_memory.h"
#include "app/picture_sink.h"
#include "app/pictures.h"
#include "app/scene_colors.h"
#include "souple/error.h"

namespace souple::app {

namespace {

SinkRequest sink_request(const std::filesystem::path& file) {
  if (output_kind(file, false) != OutputKind::picture)
    throw Error("--picture " + file.string() + ": expected the name of a picture, ending in .png");
  SinkRequest request;
  request.out = file;
  return request;
}

}  // namespace

struct LastPicture::Impl {
  PictureLook look;
  PictureMaker maker;
  std::unique_ptr<PictureSink> sink;
};

LastPicture::LastPicture(const std::filesystem::path& file, const PictureLook& look) {
  const SinkRequest request = sink_request(file);
  expect_driver_crashes();
  impl_ = std::make_unique<Impl>();
  impl_->look = look;
  impl_->sink = open_sink(request);
}

LastPicture::~LastPicture() = default;

void LastPicture::write(const World& world, const SceneDescription& scene) {
  PictureStyle style;
  style.size = {impl_->look.width, impl_->look.height};
  style.display.pins = false;
  render::Subject subject = render::subject_of(world);
  add_colors(scene, subject);
  const render::Camera camera = camera_for({}, &scene.camera, extent_of(subject), style.aspect());
  impl_->sink->add(impl_->maker.picture(subject, camera, style, impl_->look.label), 0);
}

}  // namespace souple::app
