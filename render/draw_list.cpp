#include "render/draw_list.h"

#include <algorithm>
#include <cmath>

namespace souple::render {

namespace {

// Bounding box of the finite points: otherwise an object with non-finite points would move the others out of
// view.
Bounds box_of(std::span<const Vec3f> points) {
  Bounds box;
  for (const Vec3f& p : points) {
    if (!is_finite(p)) continue;
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
  }
  return box;
}

Bounds box_of_ellipsoids(const Liquid& liquid) {
  Bounds box;
  if (liquid.ellipsoids.size() != liquid.centers.size()) return box;
  for (std::size_t i = 0; i < liquid.centers.size(); ++i) {
    const auto& [x, y, z] = liquid.ellipsoids[i].column;
    const Vec3f half{length(Vec3f{x.x, y.x, z.x}), length(Vec3f{x.y, y.y, z.y}),
                     length(Vec3f{x.z, y.z, z.z})};
    if (!is_finite(liquid.centers[i]) || !is_finite(half)) continue;
    box.add(liquid.centers[i] - half);
    box.add(liquid.centers[i] + half);
  }
  return box;
}

// Bounding box of the transformed corners: a little larger than that of the transformed points.
Bounds box_of(const Surface& surface) {
  const Bounds own = box_of(surface.positions);
  Bounds box;
  if (own.empty()) return box;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d point{(corner & 1) != 0 ? own.hi.x : own.lo.x, (corner & 2) != 0 ? own.hi.y : own.lo.y,
                      (corner & 4) != 0 ? own.hi.z : own.lo.z};
    box.add(Vec3f(surface.pose.point(point)));
  }
  return box;
}

}  // namespace

Vec3f absorption_of(const Color& left, float distance) {
  const auto channel = [&](float c) { return -std::log(std::clamp(c, 0.005f, 1.0f)) / distance; };
  return {channel(left.r), channel(left.g), channel(left.b)};
}

Bounds DrawList::bounds() const {
  Bounds box;
  const auto add = [&box](std::span<const Vec3f> centers, float radius) {
    const Bounds of_centers = box_of(centers);
    if (of_centers.empty()) return;
    box.add(of_centers.lo, radius);
    box.add(of_centers.hi, radius);
  };
  for (const Liquid& liquid : liquids) {
    add(liquid.centers, liquid.radius);
    box.add(box_of_ellipsoids(liquid));
  }
  for (const Foam& foam : foams) add(foam.centers, foam.radius);
  for (const Surface& surface : surfaces) box.add(box_of(surface));
  for (const Spheres& balls : spheres) {
    if (balls.radii.empty()) {
      add(balls.centers, balls.radius);
      continue;
    }
    for (std::size_t i = 0; i < std::min(balls.centers.size(), balls.radii.size()); ++i) {
      if (is_finite(balls.centers[i])) box.add(balls.centers[i], balls.radii[i]);
    }
  }
  return box;
}

}  // namespace souple::render
