#include "souple/fluid/surface_planes.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

// In units of the reach.
constexpr float same_distance = 1e-4f;
constexpr float on_plane = 1e-3f;  // distance from a plane at which a point counts as on it
constexpr float least_distance = 0.1f;

constexpr float least_visible = 0.15f;  // of an edge, to be a plane of its own
constexpr float turned_away = 5;  // how much faster than others planes fade that are nearer than the surface

}  // namespace

void SurfacePlanes::add(std::uint32_t triangle, const std::array<Vec3f, 3>& corners, const Vec3f& weights,
                        const Vec3f& foot, const Vec3f& normal) {
  const float distance = length(foot);
  const float side = dot(normal, foot) > 0 ? -1.0f : 1.0f;
  const Vec3f direction = distance > on_plane * reach_ ? foot * (-side / distance) : normal;
  triangles_.push_back({.plane = {triangle, direction, weights, foot, side * distance, 1},
                        .corners = corners,
                        .face = normal,
                        .inside = weights.x > 0 && weights.y > 0 && weights.z > 0});
}

// At a shared edge or vertex several triangles have the same distance. The triangle that faces the particle
// most decides whether it is inside: the planes of the other triangles may have it on the wrong side.
SurfacePlanes::Near* SurfacePlanes::nearest() {
  Near* best = nullptr;
  float least = reach_, most = 0;
  for (Near& t : triangles_) {
    const float distance = std::fabs(t.plane.distance);
    if (distance > least + same_distance * reach_) continue;
    const float facing = std::fabs(dot(t.face, t.plane.foot));
    if (best && distance > least - same_distance * reach_ && facing <= most) continue;
    best = &t;
    least = std::min(distance, least);
    most = facing;
  }
  return best;
}

// Distance of the particle beyond the plane that bisects the fold of a plane with a selected one. No part of the
// surface is nearer than the first selected plane. A plane that is nearer belongs to a face that turns away and ends
// before it reaches the particle.
float SurfacePlanes::beyond_fold(const SurfacePlane& plane, const SurfacePlane& selected) const {
  const float difference = plane.distance - selected.distance;
  const float beyond =
      selected.triangle == planes_[0].triangle ? std::max(difference, -turned_away * difference) : difference;
  return beyond > 0 ? beyond / std::max(length(plane.normal - selected.normal), 1e-6f) : 0;
}

// A triangle without a corner above a selected plane lies in the plane's half-space. A triangle that rises
// from the half-space forms a concave fold with it: its own plane bounds the solid there.
void SurfacePlanes::hide_behind(const SurfacePlane& selected) {
  const Vec3f& n = selected.normal;
  const float level = dot(n, selected.foot), none = level + on_plane * reach_;
  const float height = std::max(selected.distance, least_distance * reach_);
  for (Near& t : triangles_) {
    if (!t.open) continue;
    if (std::fabs(t.plane.distance) > influence_ ||
        !(std::max({dot(n, t.corners[0]), dot(n, t.corners[1]), dot(n, t.corners[2])}) > none)) {
      t.open = false;
      continue;
    }
    if (!t.inside) {
      const float foot = dot(n, t.plane.foot);
      t.visible = std::min(t.visible, (foot - level) / height * (1 + least_visible) - least_visible);
      if (foot > none) continue;
      t.inside = true;
      t.plane.normal = t.face;
      t.plane.distance = -dot(t.face, t.plane.foot);
      t.visible = 1;
    }
    t.open = t.plane.distance >= 0 && beyond_fold(t.plane, selected) < blend_width_;
  }
}

//   w_k = (1 - b_k / L)^2,   b_k = max_j (s_k - s_j) / |n_k - n_j|
float SurfacePlanes::weight(std::size_t k) const {
  float beyond = 0;
  for (std::size_t j = 0; j < count_ && k > 0; ++j)
    if (j != k) beyond = std::max(beyond, beyond_fold(planes_[k], planes_[j]));
  const float t = std::max(1 - beyond / blend_width_, 0.0f);
  return t * t;
}

//   share_k = w_k / sum_j (1 - f_jk) w_j,   f_jk = min(1, sqrt(1 - n_j . n_k)),   f_kk = 0
//
// f_jk approximates the part of a half-space outside another one that is turned against it.
void SurfacePlanes::find_shares() {
  std::array<float, max_planes> w{};
  for (std::size_t k = 0; k < count_; ++k) w[k] = weight(k);
  for (std::size_t k = 0; k < count_; ++k) {
    if (!(w[k] > 0)) {
      planes_[k].share = 0;
      continue;
    }
    float sum = 0;
    for (std::size_t j = 0; j < count_; ++j) {
      const float turned = 1 - dot(planes_[j].normal, planes_[k].normal);
      sum += j == k ? w[k] : (1 - std::sqrt(std::clamp(turned, 0.0f, 1.0f))) * w[j];
    }
    planes_[k].share *= w[k] / sum;
  }
}

SurfacePlanes::Near* SurfacePlanes::next() {
  Near* best = nullptr;
  for (Near& t : triangles_)
    if (t.open && t.visible > 0 && (!best || t.plane.distance < best->plane.distance)) best = &t;
  return best;
}

std::span<const SurfacePlane> SurfacePlanes::select() {
  for (Near* t = nearest(); t; t = next()) {
    t->open = false;
    planes_[count_] = t->plane;
    planes_[count_].share = t->visible;
    if (++count_ == max_planes) break;
    hide_behind(t->plane);
  }
  find_shares();
  return {planes_.data(), count_};
}

}  // namespace souple
