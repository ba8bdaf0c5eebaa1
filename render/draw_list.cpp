#include "render/draw_list.h"

namespace souple::render {

Bounds DrawList::bounds() const {
  Bounds box;
  for (const Surface& surface : surfaces) {
    // The box of the points, then of its posed corners: a little larger than that of the posed points.
    Bounds own;
    for (const Vec3f& point : surface.positions) {
      if (is_finite(point)) own.add(point);
    }
    if (own.empty()) continue;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d point{(corner & 1) != 0 ? own.hi.x : own.lo.x, (corner & 2) != 0 ? own.hi.y : own.lo.y,
                        (corner & 4) != 0 ? own.hi.z : own.lo.z};
      box.add(Vec3f(surface.pose.point(point)));
    }
  }
  for (const Spheres& balls : spheres) {
    for (std::size_t i = 0; i < balls.centres.size(); ++i) {
      if (is_finite(balls.centres[i])) {
        box.add(balls.centres[i], balls.radii.empty() ? balls.radius : balls.radii[i]);
      }
    }
  }
  return box;
}

}  // namespace souple::render
