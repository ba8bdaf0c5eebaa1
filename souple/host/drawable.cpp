#include "souple/host/drawable.h"

#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"

#include <algorithm>
#include <cmath>

namespace souple::host {

namespace {

// Vertices of a rim edge: a and b on each side, with a normal of their own.
constexpr std::size_t border_vertices = 4;
// Minimum distance from a cloth's middle to a side: closer sides show through each other in large scenes. [m]
constexpr float least_distance = 0.001f;

Vec3f at(const std::vector<float>& values, std::size_t v) {
  return {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
}

void put(std::vector<float>& values, std::size_t v, const Vec3f& x) {
  for (int axis = 0; axis < 3; ++axis) values[3 * v + static_cast<std::size_t>(axis)] = x[axis];
}

}  // namespace

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
    if (two_sided_) {
      add_rim();
      drawn = 2 * object_vertices_ + border_vertices * borders_.size();
    }
    drawn_normals_.resize(3 * drawn);
  }
  drawn_positions_.resize(3 * drawn);
}

void Drawable::add_other_side() {
  const std::size_t count = triangles_.size();
  const auto offset = static_cast<std::uint32_t>(object_vertices_);
  for (std::size_t t = 0; t < count; t += 3)
    for (const std::size_t corner : {std::size_t{0}, std::size_t{2}, std::size_t{1}})
      triangles_.push_back(triangles_[t + corner] + offset);
}

void Drawable::add_rim() {
  std::vector<Triangle> side(triangles_.size() / 3);
  for (std::size_t i = 0; i < triangles_.size(); ++i) side[i / 3][i % 3] = triangles_[i];
  add_other_side();
  auto first = static_cast<std::uint32_t>(2 * object_vertices_);
  for (const Edge& edge : boundary_edges(side)) {
    borders_.push_back({edge[0], edge[1]});
    const std::uint32_t a = first, b = first + 1, other_a = first + 2, other_b = first + 3;
    triangles_.insert(triangles_.end(), {a, other_a, other_b, a, other_b, b});
    first += border_vertices;
  }
}

void Drawable::place_balls(Session& session) {
  for (std::uint32_t i = 0; i < object_vertices_; ++i) balls_.push_back({i, i, 0});
  const std::vector<std::uint32_t> segments = session.segments(object_);
  if (segments.empty() || !(radius_ > 0)) return;
  // From the current length. Balls one radius apart overlap enough to look like a tube.
  constexpr float most = 64;
  session.write(object_, {positions_.data()}, object_vertices_);
  for (std::size_t s = 0; s < segments.size(); s += 2) {
    const std::uint32_t a = segments[s], b = segments[s + 1];
    const float *from = &positions_[3 * std::size_t{a}], *to = &positions_[3 * std::size_t{b}];
    const float x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
    const float length = std::sqrt(x * x + y * y + z * z);
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
  const float distance = two_sided_ ? std::max(radius_, least_distance) : 0;
  for (std::size_t i = 0; i < count; ++i) {
    drawn_positions_[i] = positions_[i] + distance * normals_[i];
    drawn_normals_[i] = normals_[i];
  }
  if (!two_sided_) return;
  for (std::size_t i = 0; i < count; ++i) {
    drawn_positions_[count + i] = positions_[i] - distance * normals_[i];
    drawn_normals_[count + i] = -normals_[i];
  }
  draw_rim();
}

void Drawable::draw_rim() {
  std::size_t out = 2 * object_vertices_;
  for (const auto& [a, b] : borders_) {
    const Vec3f along = at(positions_, b) - at(positions_, a);
    const Vec3f across = cross(along, at(normals_, a) + at(normals_, b));
    const float size = length(across);
    const Vec3f outward = size > 0 ? across / size : at(normals_, a);
    for (const std::size_t from :
         {std::size_t{a}, std::size_t{b}, object_vertices_ + a, object_vertices_ + b}) {
      put(drawn_positions_, out, at(drawn_positions_, from));
      put(drawn_normals_, out++, outward);
    }
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
  if (drawn < 2 * count) return drawn % count;
  const Border& border = borders_.at((drawn - 2 * count) / border_vertices);
  return drawn % 2 == 0 ? border.a : border.b;
}

}  // namespace souple::host
