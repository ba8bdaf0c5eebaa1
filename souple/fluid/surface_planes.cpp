#include "souple/fluid/surface_planes.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

// In units of the reach.
constexpr float same_distance = 1e-4f;
constexpr float on_plane = 1e-3f;  // distance from a plane at which a point counts as on it
constexpr float least_distance = 0.1f;

constexpr float turned_away = 5;  // how much faster than others planes fade that are nearer than the surface

}  // namespace

void SurfacePlanes::add(std::uint32_t triangle, const std::array<Vec3f, 3>& corners, const Vec3f& weights,
                        const Vec3f& normal) {
  const Vec3f foot = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
  const float distance = length(foot);
  if (distance > reach_) return;
  const float height = -dot(normal, foot), side = height < 0 ? -1.0f : 1.0f;
  const Vec3f direction = distance > on_plane * reach_ ? foot * (-side / distance) : normal;
  triangles_.push_back({.plane = {triangle, direction, weights, foot, side * distance, 1},
                        .corners = corners,
                        .face = normal,
                        .inside = weights.x > 0 && weights.y > 0 && weights.z > 0});
}

// At a shared edge or vertex several triangles have the same distance. The triangle that faces the particle
// most decides whether it is inside: the planes of the other triangles may have it on the wrong side.
const SurfacePlanes::Near* SurfacePlanes::nearest() const {
  const Near* best = nullptr;
  float least = reach_, most = 0;
  for (const Near& t : triangles_) {
    const float distance = length(t.plane.foot), facing = std::fabs(dot(t.face, t.plane.foot));
    if (distance > least + same_distance * reach_) continue;
    if (best && distance > least - same_distance * reach_ && facing <= most) continue;
    best = &t;
    least = std::min(distance, least);
    most = facing;
  }
  return best;
}

// A triangle without a corner above a selected plane lies in the plane's half-space. A triangle that rises
// from the half-space forms a concave fold with it: its own plane bounds the solid there.
void SurfacePlanes::hide_behind(const SurfacePlane& selected) {
  const Vec3f& n = selected.normal;
  const float height = std::max(selected.distance, least_distance * reach_), none = on_plane * reach_;
  std::erase_if(triangles_, [&](Near& t) {
    const auto rise = [&](const Vec3f& point) { return dot(n, point - selected.foot); };
    if (!(std::max({rise(t.corners[0]), rise(t.corners[1]), rise(t.corners[2])}) > none)) return true;
    const float foot = rise(t.plane.foot);
    if (!t.inside && foot <= none) {
      t.inside = true;
      t.plane.normal = t.face;
      t.plane.distance = -dot(t.face, t.plane.foot);
      t.visible = 1;
    }
    if (!t.inside) t.visible = std::min(t.visible, foot / height);
    return false;
  });
}

//   share_k = w_k / sum_j (1 - f_jk) w_j,   f_jk = min(1, sqrt(1 - n_j . n_k)),   f_kk = 0
//   w_k = (1 - b_k / L)^2,   b_k = max_j (s_k - s_j) / |n_k - n_j|
//
// with b_k the distance beyond the planes that bisect folds with other planes. f_jk approximates the part of
// a half-space outside another one that is turned against it. No part of the surface is nearer than s_0: a
// plane that is nearer belongs to a face that turns away and ends before it reaches the particle.
void SurfacePlanes::find_shares() {
  std::array<float, max_planes> w{};
  for (std::size_t k = 0; k < count_; ++k) {
    float beyond = 0;
    for (std::size_t j = 0; j < count_; ++j) {
      const float turn = std::max(length(planes_[k].normal - planes_[j].normal), 1e-6f);
      const float difference = planes_[k].distance - planes_[j].distance;
      if (k > 0 && j == 0) beyond = std::max(beyond, std::max(difference, -turned_away * difference) / turn);
      if (k > 0 && j > 0) beyond = std::max(beyond, difference / turn);
    }
    const float t = std::max(1 - beyond / blend_width_, 0.0f);
    w[k] = t * t;
  }
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

std::span<const SurfacePlane> SurfacePlanes::select() {
  const Near* next = nearest();
  while (next) {
    planes_[count_] = next->plane;
    planes_[count_].share = next->visible;
    const SurfacePlane selected = planes_[count_++];
    if (count_ == max_planes) break;
    hide_behind(selected);
    next = nullptr;
    for (const Near& t : triangles_) {
      if (t.plane.distance < 0 || !(t.visible > 0)) continue;
      if (!next || t.plane.distance < next->plane.distance) next = &t;
    }
  }
  find_shares();
  return {planes_.data(), count_};
}

}  // namespace souple
