#include "souple/collision/sphere_cast.h"

namespace souple {

std::optional<SphereCastHit> sphere_cast(const Shape& shape, const SurfaceDistance& start, const Vec3d& from,
                                         const Vec3d& to, double r) {
  const Vec3d motion = to - from;
  const double path = length(motion);
  if (start.distance <= r) {
    if (dot(start.normal, motion) < 0) return SphereCastHit{start, from};
    if (is_convex(shape)) return std::nullopt;
    r = 0.5 * start.distance;
  }
  const double near_enough = 1e-4 * (start.distance - r);
  SphereCastHit hit{start, from};
  double gone = 0;
  for (int stride = 0; stride < 64; ++stride) {
    const double free = hit.surface.distance - r;
    if (free <= near_enough) break;
    gone += free;
    if (gone >= path) return std::nullopt;
    hit.point = from + motion * (gone / path);
    hit.surface = surface_distance(shape, hit.point);
  }
  return hit;
}

bool may_tunnel(double start, double end, double path, double r) {
  if (end <= 0 || path >= start + end) return true;
  return path > r && path >= start + end - 2 * r;
}

}  // namespace souple
