#include "web/src/page_view.h"

#include "render/color.h"
#include "souple/error.h"
#include "souple/objects/kind_traits.h"

#include <algorithm>

namespace souple::web {

namespace {

constexpr float finger = 14;  // distance from a thin rope at which a finger still takes it [pixels]
constexpr float usual_aspect = 1.5f;

}  // namespace

HeldWorld& PageView::world() const {
  if (world_ == nullptr) throw Error("no scene is open");
  return *world_;
}

render::Subject PageView::subject() const {
  render::Subject subject = world().simulation().subject();
  subject.topology += number_ << 32;  // each simulation numbers its worlds from 1
  return subject;
}

void PageView::show(HeldWorld* world, int width, int height) {
  world_ = world;
  ++number_;
  width_ = std::max(width, 1), height_ = std::max(height, 1);
  if (world_ == nullptr) return;
  world_->keep_past();
  camera_ = world_->simulation().camera().value_or(render::Camera{});
  // On a narrow screen the scene keeps its width.
  const float aspect = static_cast<float>(width_) / static_cast<float>(height_);
  if (aspect < usual_aspect) camera_.zoom(usual_aspect / aspect);
}

void PageView::draw(int width, int height) {
  width_ = std::max(width, 1), height_ = std::max(height, 1);
  if (world_ == nullptr) return;
  drawing_.update(subject(), display_);
  if (world_->grabbing()) {
    const render::PackedColor color = render::pack(render::srgb(0xf0a35e));
    drawing_.list().top_lines.push_back({world_->grabbed_point(), world_->drag_target(), color, 2.5f});
  }
  renderer_.draw(drawing_.list(), camera_, rendering_, width, height);
}

void PageView::advance(double seconds) {
  if (world_ != nullptr) world_->simulation().advance(seconds);
}

host::Ray PageView::ray(float x, float y) const {
  const render::Ray ray = camera_.ray(x, y, width_, height_);
  return {ray.origin, ray.direction};
}

float PageView::reach() const {
  return finger * camera_.pixel_size(camera_.distance(), height_);
}

bool PageView::grab(float x, float y) {
  return world().grab(ray(x, y), reach(), camera_.forward());
}

void PageView::drag(float x, float y) {
  world().drag(ray(x, y));
}

bool PageView::toggle_pin(float x, float y) {
  const host::Ray at = ray(x, y);
  const Hit hit = world().world().ray_cast(at.origin, at.direction);
  if (!hit.found || hit.is_collider || traits_of(world().world().kind(hit.object)).driven) return false;
  world().simulation().toggle_pin(hit.object, hit.vertex);
  return true;
}

Vec3f PageView::point_at(float x, float y) const {
  const host::Ray at = ray(x, y);
  const double far = 4 * static_cast<double>(camera_.distance());
  const Hit hit = world().world().ray_cast(at.origin, at.direction, far);
  return hit.found ? hit.point : at.origin + at.direction * camera_.distance();
}

void PageView::throw_ball(float x, float y) {
  const Vec3f& gravity = world().simulation().scene().settings.gravity;
  const viewer::Ball ball = viewer::ball_for(camera_.distance(), length(gravity));
  const host::Ray at = ray(x, y);
  const Vec3f from = at.origin + at.direction * (2 * ball.radius);
  const Vec3f direction = viewer::aim(from, point_at(x, y), ball.speed, gravity);
  world().simulation().add(viewer::thrown(ball, from, direction), true);
}

void PageView::add(viewer::Addition addition, float x, float y) {
  const viewer::NewObject object = viewer::described(addition, static_cast<double>(camera_.distance()) / 8);
  world().simulation().add(viewer::placed_above(point_at(x, y), world().world(), object));
}

void PageView::add(const std::filesystem::path& mesh) {
  const viewer::NewObject object = viewer::described(mesh);
  const Vec3f middle = point_at(0.5f * static_cast<float>(width_), 0.5f * static_cast<float>(height_));
  world().simulation().add(viewer::placed_above(middle, world().world(), object));
}

void PageView::frame_all() {
  render::Bounds bounds;
  for (const render::Body& body : subject().bodies)
    for (const Vec3f& point : body.positions) bounds.add(point, body.radius);
  if (!bounds.empty()) camera_.frame(bounds, static_cast<float>(width_) / static_cast<float>(height_));
}

}  // namespace souple::web
