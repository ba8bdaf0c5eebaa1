#include "souple/fluid/foam_bodies.h"

#include "souple/collision/continuous.h"
#include "souple/collision/nearest.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {

namespace {

constexpr std::size_t foam_chunk = 512;

}  // namespace

void FoamBodies::build(Threads& threads) {
  resize_with_spare(boxes_, triangles_.size());
  threads.for_each(triangles_.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const MovingTriangle& triangle = triangles_[t];
      Bounds box{triangle.start[0], triangle.start[0]};
      for (std::size_t c = 0; c < 3; ++c)
        box = united(united(box, {triangle.start[c], triangle.start[c]}), {triangle.end[c], triangle.end[c]});
      boxes_[t] = widened(box, triangle.gap);
    }
  });
  hash_.build(boxes_, SpatialHash::choose_cell_size(boxes_), threads);
}

// The normal is the direction from the nearest point at the time of impact, not the triangle's normal. So it is right
// at edges too, and on either side.
FoamBodies::Impact FoamBodies::find_impact(const MovingTriangle& triangle, const Vec3f& start,
                                           const Vec3f& x) {
  Moving4 motion;
  motion.x[0] = Vec3d{}, motion.p[0] = Vec3d(x - start);
  for (std::size_t c = 0; c < 3; ++c) {
    motion.x[c + 1] = Vec3d(triangle.start[c] - start);
    motion.p[c + 1] = Vec3d(triangle.end[c] - start);
  }
  Impact result;
  result.gap = static_cast<double>(triangle.gap);
  result.time = vertex_triangle_time(motion, result.gap);
  if (!(result.time < 1)) return result;
  Vec3d at[4];
  for (std::size_t k = 0; k < 4; ++k) at[k] = motion.x[k] + (motion.p[k] - motion.x[k]) * result.time;
  double weight[3];
  nearest_on_triangle(at[0], at[1], at[2], at[3], weight);
  const Vec3d offset = at[0] - (at[1] * weight[0] + at[2] * weight[1] + at[3] * weight[2]);
  const double distance = length(offset);
  result.normal = distance > 1e-9 ? offset / distance : normalized(cross(at[2] - at[1], at[3] - at[1]));
  result.point = Vec3d(start) + motion.p[1] * weight[0] + motion.p[2] * weight[1] + motion.p[3] * weight[2];
  return result;
}

// A push by one triangle may cause an impact on another. A particle that still crosses a triangle after all
// rounds, as in a fold, stays at its first impact. A particle that grazes a triangle is not stopped.
Vec3f FoamBodies::stopped(const Vec3f& start, const Vec3f& x, std::vector<std::uint32_t>& near) const {
  constexpr int rounds = 4;
  constexpr double tolerance = 1e-3;  // of the gap: float precision
  Vec3f at = x;
  for (int round = 0;; ++round) {
    near.clear();
    hash_.find(united({start, start}, {at, at}), near);
    Impact first;
    double missing = 0;
    for (const std::uint32_t t : near) {
      const Impact impact = find_impact(triangles_[t], start, at);
      if (!(impact.time < first.time)) continue;
      const double depth = impact.gap - dot(impact.normal, Vec3d(at) - impact.point);
      if (depth > impact.gap * tolerance) first = impact, missing = depth;
    }
    if (!(first.time < 1)) return at;
    if (round == rounds) return Vec3f(first.point + first.normal * first.gap);
    at = Vec3f(Vec3d(at) + first.normal * missing);
  }
}

void FoamBodies::keep_out(std::span<const Vec3f> start, std::span<Vec3f> x, Threads& threads) {
  if (none()) return;
  const std::size_t chunks = (x.size() + foam_chunk - 1) / foam_chunk;
  if (near_.size() < chunks) near_.resize(chunks);
  threads.each(chunks, 1, [&](std::size_t c) {
    for (std::size_t k = c * foam_chunk; k < std::min(x.size(), (c + 1) * foam_chunk); ++k)
      if (is_finite(x[k])) x[k] = stopped(start[k], x[k], near_[c]);
  });
}

std::size_t FoamBodies::bytes() const {
  return bytes_of(triangles_, boxes_, near_) + hash_.bytes();
}

}  // namespace souple
