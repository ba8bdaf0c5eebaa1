#include "souple/collision/first_touch.h"

namespace souple {

std::optional<Touch> first_touch(const Shape& shape, const SurfaceDistance& start, const Vec3d& from,
                                 const Vec3d& to, double r) {
  const Vec3d motion = to - from;
  const double path = length(motion);
  if (start.distance <= r) {
    if (dot(start.normal, motion) < 0) return Touch{start, from};
    if (is_convex(shape)) return std::nullopt;
    r = 0.5 * start.distance;
  }
  const double near_enough = 1e-4 * (start.distance - r);
  Touch touch{start, from};
  double gone = 0;
  for (int stride = 0; stride < 64; ++stride) {
    const double free = touch.surface.distance - r;
    if (free <= near_enough) break;
    gone += free;
    if (gone >= path) return std::nullopt;
    touch.point = from + motion * (gone / path);
    touch.surface = surface_distance(shape, touch.point);
  }
  return touch;
}

bool may_pass(double start, double end, double path, double r) {
  if (end <= 0 || path >= start + end) return true;
  return path > r && path >= start + end - 2 * r;
}

}  // namespace souple
