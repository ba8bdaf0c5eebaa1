#include "souple/host/drawable.h"

#include <algorithm>
#include <cmath>

namespace souple::host {

Drawable::Drawable(Session& session, Handle object, Sides sides) : object_(object) {
  const ObjectInfo info = session.object(object);
  radius_ = info.radius;
  object_vertices_ = info.vertex_count;
  triangles_ = session.triangles(object);
  positions_.resize(3 * object_vertices_);
  two_sided_ = sides == Sides::two && info.kind == Kind::cloth && info.from_scene;
  std::size_t drawn = object_vertices_;
  if (triangles_.empty()) {
    place_balls(session);
    drawn = balls_.size();
  } else {
    normals_.resize(positions_.size());
    if (two_sided_) add_other_side();
    if (two_sided_) drawn *= 2;
    drawn_normals_.resize(3 * drawn);
  }
  drawn_positions_.resize(3 * drawn);
}

void Drawable::add_other_side() {
  const std::size_t count = triangles_.size();
  const auto offset = static_cast<std::uint32_t>(object_vertices_);
  for (std::size_t t = 0; t < count; t += 3)
    for (const std::size_t corner : {0, 2, 1}) triangles_.push_back(triangles_[t + corner] + offset);
}

void Drawable::place_balls(Session& session) {
  for (std::uint32_t i = 0; i < object_vertices_; ++i) balls_.push_back({i, i, 0});
  const std::vector<std::uint32_t> segments = session.segments(object_);
  if (segments.empty() || !(radius_ > 0)) return;
  // Of the length they have now. Balls one radius apart overlap by so much that they look like one tube.
  constexpr float most = 64;
  session.write(object_, {positions_.data()}, object_vertices_);
  for (std::size_t s = 0; s < segments.size(); s += 2) {
    const std::uint32_t a = segments[s], b = segments[s + 1];
    const float *from = &positions_[3 * std::size_t{a}], *to = &positions_[3 * std::size_t{b}];
    const float length = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    const float parts = std::clamp(std::ceil(length / radius_), 1.0f, most);
    for (float k = 1; k < parts; ++k) balls_.push_back({a, b, k / parts});
  }
}

void Drawable::update(Session& session) {
  session.write(object_, {positions_.data(), normals_.empty() ? nullptr : normals_.data()}, object_vertices_);
  if (balls())
    draw_balls();
  else
    draw_sides();
}

void Drawable::draw_sides() {
  const std::size_t count = positions_.size();
  const float distance = two_sided_ ? radius_ : 0;
  for (std::size_t i = 0; i < count; ++i) {
    drawn_positions_[i] = positions_[i] + distance * normals_[i];
    drawn_normals_[i] = normals_[i];
  }
  if (!two_sided_) return;
  for (std::size_t i = 0; i < count; ++i) {
    drawn_positions_[count + i] = positions_[i] - distance * normals_[i];
    drawn_normals_[count + i] = -normals_[i];
  }
}

void Drawable::draw_balls() {
  float* out = drawn_positions_.data();
  for (const Ball& ball : balls_) {
    const float *a = &positions_[3 * std::size_t{ball.a}], *b = &positions_[3 * std::size_t{ball.b}];
    for (int axis = 0; axis < 3; ++axis) *out++ = a[axis] + ball.t * (b[axis] - a[axis]);
  }
}

std::uint32_t Drawable::vertex_of(std::uint32_t drawn) const {
  if (balls()) {
    const Ball& ball = balls_.at(drawn);
    return ball.t < 0.5f ? ball.a : ball.b;
  }
  const auto count = static_cast<std::uint32_t>(object_vertices_);
  return drawn < count ? drawn : drawn - count;
}

}  // namespace souple::host
