#include "render/draw_list.h"

#include <algorithm>

namespace souple::render {

namespace {

// The box of the points that are finite: a broken object must not take the others out of sight.
Bounds box_of(std::span<const Vec3f> points) {
  Bounds box;
  for (const Vec3f& p : points) {
    if (!is_finite(p)) continue;
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
  }
  return box;
}

// The box of the posed corners: a little larger than that of the posed points.
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

Bounds DrawList::bounds() const {
  Bounds box;
  for (const Surface& surface : surfaces) box.add(box_of(surface));
  for (const Spheres& balls : spheres) {
    if (balls.radii.empty()) {
      const Bounds centres = box_of(balls.centres);
      if (centres.empty()) continue;
      box.add(centres.lo, balls.radius);
      box.add(centres.hi, balls.radius);
      continue;
    }
    for (std::size_t i = 0; i < std::min(balls.centres.size(), balls.radii.size()); ++i) {
      if (is_finite(balls.centres[i])) box.add(balls.centres[i], balls.radii[i]);
    }
  }
  return box;
}

}  // namespace souple::render
