#include "app/pictures.h"

#include "render/moving_subject.h"
#include "souple/error.h"

#include <algorithm>

namespace souple::app {

namespace {

/// Whether the camera differs from the default, which a scene without the key `camera` has.
bool is_given(const CameraDescription& camera) {
  const CameraDescription standard;
  return !(camera.from == standard.from && camera.to == standard.to && camera.fov == standard.fov);
}

}  // namespace

namespace {

/// Corners of the box around a collider of finite size, in the world.
void add_collider(const render::ColliderBody& collider, render::ExtremePoints& extent) {
  const ShapeBounds box = shape_bounds(*collider.shape);
  if (!is_finite(box.lo) || !is_finite(box.hi)) return;
  for (const double x : {box.lo.x, box.hi.x})
    for (const double y : {box.lo.y, box.hi.y})
      for (const double z : {box.lo.z, box.hi.z}) extent.add(Vec3f(collider.pose.point({x, y, z})));
}

}  // namespace

render::ExtremePoints extent_of(const render::Subject& subject) {
  render::ExtremePoints extent;
  for (const render::Body& body : subject.bodies) {
    for (const Vec3f& x : body.positions) extent.add(x, body.radius);
  }
  return extent;
}

render::ExtremePoints extent_with_colliders(const render::Subject& subject) {
  constexpr float much = 2;
  render::ExtremePoints extent = extent_of(subject);
  const float radius = extent.bounds().radius();
  for (const render::ColliderBody& collider : subject.colliders) {
    render::ExtremePoints box;
    add_collider(collider, box);
    if (box.bounds().radius() <= much * radius) extent.add(box);
  }
  return extent;
}

bool is_automatic(const CameraRequest& request, const CameraDescription* scene) {
  const bool given = scene != nullptr && is_given(*scene);
  return request.automatic || !(given || request.from || request.to);
}

render::Camera camera_for(const CameraRequest& request, const CameraDescription* scene,
                          const render::ExtremePoints& extent, float aspect) {
  render::Camera camera;
  const bool given = scene != nullptr && is_given(*scene);
  if (given) {
    camera.from = Vec3f(scene->from);
    camera.to = Vec3f(scene->to);
    camera.fov = static_cast<float>(scene->fov);
  }
  camera.from = request.from.value_or(camera.from);
  camera.to = request.to.value_or(camera.to);
  camera.fov = request.fov.value_or(camera.fov);
  if (camera.from == camera.to)
    throw Error("--camera: \"from\" and \"to\" are the same point; expected two different points");
  if (is_automatic(request, scene)) {
    camera.turn_to_fill(extent.points(), aspect);
    camera.frame(extent.points(), aspect);
  }
  return camera;
}

namespace {

/// In the lower left corner.
render::Label label_of(const std::string& text, const PictureStyle& style) {
  render::Label words;
  words.text = text;
  words.size = std::max(12.0f, static_cast<float>(style.size.height) / 16);
  words.x = 0.4f * words.size;
  words.y = static_cast<float>(style.size.height) - 1.4f * words.size;
  words.background = render::Color{0, 0, 0, 0.5f};
  return words;
}

}  // namespace

render::Image PictureMaker::picture(const render::Subject& subject, const render::Camera& camera,
                                    const PictureStyle& style, const std::string& label) {
  const auto list_of = [&](const render::Subject& at) -> const render::DrawList& {
    const render::DrawList& list = drawing_.update(at, style.display);
    if (!label.empty()) drawing_.list().labels.push_back(label_of(label, style));
    if (style.caustics) drawing_.list().light.caustics = true;
    if (style.sky) drawing_.list().light.environment = style.sky;
    return list;
  };
  render::RenderOptions options;
  options.samples = style.samples;
  options.liquid_filter = style.liquid_filter;
  options.liquid_steps = style.liquid_steps;
  options.focus = style.focus > 0 ? style.focus : camera.distance();
  options.aperture = style.aperture;
  const auto [width, height] = style.size;
  if (!(style.exposure > 0)) return renderer_.picture(list_of(subject), camera, options, width, height);
  render::MovingSubject moving(subject, style.exposure);
  const auto list_at = [&](float time) -> const render::DrawList& { return list_of(moving.at(time)); };
  return renderer_.moving_picture(list_at, camera, options, width, height);
}
}  // namespace souple::app
