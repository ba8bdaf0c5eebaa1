#include "souple/surface/narrow_band.h"

#include "souple/collision/mesh_tree.h"
#include "souple/error.h"
#include "souple/geometry/closest_point.h"
#include "souple/math/limits.h"
#include "souple/math/lists.h"
#include "souple/surface/bricks.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {

namespace {

constexpr int side = NarrowBand::side;
constexpr std::size_t points = NarrowBand::brick_points;

/// A triangle in its bounding ball, and the range of grid points that may be near it. Lengths in cells.
struct Ball {
  std::array<Vec3d, 3> corners;
  Vec3d center;
  double radius = 0;
  std::array<std::int32_t, 3> first{}, last{};
};

/// Fills one brick at a time. Lengths are in cells.
///
/// A point p needs the exact distance to few triangles only. Centers c are on their triangles, so the surface
/// is no further than the nearest center. A triangle in a ball of radius r around c is no nearer than |p - c|
/// - r. Both bounds are computed for many points at a time, relative to the brick's first point, with a
/// margin for float rounding.
///
/// A point that is further from the surface than from its neighbor is on the same side as the neighbor. So
/// points form groups, and one winding number gives the side of a whole group. (Rejected: the sign by the
/// nearest normal, as in Baerentzen and Aanaes 2005. It needs no traversal of the whole mesh. But where the mesh is
/// turned inside out, as at tips of splashes, all points nearest to that part get the wrong side. These were 52 of
/// 51,942 points of the splash in the tests.)
class BrickSearch {
 public:
  /// `band`: gives the cell size, and the distance that points beyond `width` cells get.
  BrickSearch(std::span<const Ball> balls, const MeshTree& tree, const NarrowBand& band, int width)
      : balls_(balls), tree_(tree), cell_(double(band.cell)), width_(width), beyond_(band.width) {}

  void fill(std::span<const std::uint32_t> near, NarrowBand::Brick& brick) {
    bound(near, brick.first);
    for (float& b : bound_) b = std::sqrt(std::min(b, static_cast<float>(width_ * width_)));
    best_.fill(width_ * width_);
    for (const std::uint32_t t : near) measure(t, brick.first);
    for (double& d : best_) d = std::sqrt(d);
    for (std::size_t i = 0; i < points; ++i) {
      const auto distance = static_cast<float>(best_[i] * cell_);
      const bool in_band = best_[i] < width_ && distance < beyond_;
      brick.distances[i] = in_band ? distance : beyond_;
      if (in_band) brick.band[i / 64] |= std::uint64_t{1} << i % 64;
    }
    find_sides(brick);
  }

 private:
  static constexpr std::size_t plane = std::size_t{side} * side;
  static constexpr float rounding_margin = 1e-3f;
  // A point on the surface, a whole cell away, may be on either side.
  static constexpr double rounding_factor = 1.000001;
  static constexpr std::array<std::size_t, 3> strides = {plane, side, 1};

  /// A ball relative to a brick: the brick's points that may be near it, plane by plane of x.
  struct LocalBall {
    float x, radius;
    int first_x, last_x;
    std::size_t begin, end;            // in each plane
    std::array<float, plane> squares;  // squared distances within the plane
  };
  LocalBall local_ball(std::uint32_t t, const std::array<std::int32_t, 3>& first) const {
    const Ball& ball = balls_[t];
    const auto from = [&](std::size_t axis) { return std::max(ball.first[axis] - first[axis], 0); };
    const auto to = [&](std::size_t axis) { return std::min(ball.last[axis] - first[axis], side - 1); };
    const Vec3f c(ball.center - Vec3d(first[0], first[1], first[2]));
    LocalBall result;
    result.x = c.x;
    result.radius = static_cast<float>(ball.radius * 1.00001);
    result.first_x = from(0);
    result.last_x = to(0);
    result.begin = static_cast<std::size_t>(from(1) * side);
    result.end = static_cast<std::size_t>((to(1) + 1) * side);
    for (std::size_t i = result.begin; i < result.end; ++i) {
      const std::size_t row = i / side;
      const float y = float(row) - c.y, z = float(i % side) - c.z;
      result.squares[i] = y * y + z * z;
    }
    return result;
  }

  void bound(std::span<const std::uint32_t> near, const std::array<std::int32_t, 3>& first) {
    bound_.fill(1e30f);
    for (const std::uint32_t t : near) {
      const LocalBall ball = local_ball(t, first);
      for (int x = ball.first_x; x <= ball.last_x; ++x) {
        const float dx = float(x) - ball.x, square = dx * dx;
        float* of_plane = &bound_[static_cast<std::size_t>(x) * plane];
        for (std::size_t i = ball.begin; i < ball.end; ++i) {
          const float d = square + ball.squares[i];
          of_plane[i] = d < of_plane[i] ? d : of_plane[i];
        }
      }
    }
  }

  void measure(std::uint32_t t, const std::array<std::int32_t, 3>& first) {
    const LocalBall ball = local_ball(t, first);
    std::array<std::int32_t, plane> may;
    for (int x = ball.first_x; x <= ball.last_x; ++x) {
      const std::size_t in_plane = static_cast<std::size_t>(x) * plane;
      const float dx = float(x) - ball.x, square = dx * dx, more = ball.radius + rounding_margin;
      const float* of_plane = &bound_[in_plane];
      for (std::size_t i = ball.begin; i < ball.end; ++i) {
        const float max_distance = of_plane[i] + more;
        may[i] = square + ball.squares[i] <= max_distance * max_distance ? 1 : 0;
      }
      for (std::size_t i = ball.begin; i < ball.end; ++i)
        if (may[i] != 0) measure_at(in_plane + i, balls_[t].corners, first);
    }
  }
  void measure_at(std::size_t point, const std::array<Vec3d, 3>& corners,
                  const std::array<std::int32_t, 3>& first) {
    const auto& [a, b, c] = corners;
    const Vec3d p = position(point, first);
    const TrianglePoint w = closest_on_triangle(p, a, b, c);
    best_[point] = std::min(best_[point], length_squared(p - (a * w.a + b * w.b + c * w.c)));
  }

  void find_sides(NarrowBand::Brick& brick) {
    known_.fill(false);
    for (std::size_t i = 0; i < points; ++i) {
      if (known_[i] || !brick.in_band(i)) continue;
      const bool inside = tree_.winding_number(position(i, brick.first)) > 0.5;
      known_[i] = true;
      std::size_t waiting = 1;
      group_[0] = static_cast<std::uint16_t>(i);
      while (waiting > 0) {
        const std::size_t at = group_[--waiting];
        if (inside && brick.in_band(at)) brick.distances[at] = -brick.distances[at];
        for (const std::size_t stride : strides) {
          const std::size_t along = at / stride % side;
          if (along > 0) waiting = join(at, at - stride, waiting);
          if (along + 1 < side) waiting = join(at, at + stride, waiting);
        }
      }
    }
  }
  /// Adds a neighbor to the group's open points if it is on the same side; returns their number.
  std::size_t join(std::size_t at, std::size_t neighbor, std::size_t waiting) {
    if (known_[neighbor] || !(std::max(best_[at], best_[neighbor]) > rounding_factor)) return waiting;
    known_[neighbor] = true;
    group_[waiting] = static_cast<std::uint16_t>(neighbor);
    return waiting + 1;
  }

  static Vec3d position(std::size_t point, const std::array<std::int32_t, 3>& first) {
    const auto part = [&](std::size_t axis) {
      return static_cast<double>(first[axis] + static_cast<std::int32_t>(point / strides[axis] % side));
    };
    return {part(0), part(1), part(2)};
  }

  std::span<const Ball> balls_;
  const MeshTree& tree_;
  double cell_, width_;  // [m]; in cells
  float beyond_;
  std::array<float, points> bound_;
  std::array<double, points> best_;  // distance in cells, first squared
  std::array<bool, points> known_;
  std::array<std::uint16_t, points> group_;
};

void check(std::span<const Vec3f> positions, float cell, int width) {
  if (!(std::isfinite(cell) && cell > 0))
    throw Error(fmt::format("narrow_band: cell is {}; expected a finite length above 0 [m]", cell));
  if (width < 1 || width > 100)
    throw Error(fmt::format("narrow_band: width is {}; expected 1 to 100 cells", width));
  constexpr double furthest = double(Bricks::limit - 32) * side;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f& x = positions[i];
    const double far = std::max({std::abs(double(x.x)), std::abs(double(x.y)), std::abs(double(x.z))});
    if (!is_finite(x) || far > furthest * double(cell))
      throw Error(
          fmt::format("narrow_band: vertex {} is not finite, or too far from the origin for cells of {} m; "
                      "take larger cells",
                      i, cell));
  }
}

std::vector<Ball> balls_of(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                           double width) {
  std::vector<Ball> balls(triangles.size());
  for (std::size_t t = 0; t < balls.size(); ++t) {
    Ball& ball = balls[t];
    for (std::size_t k = 0; k < 3; ++k) ball.corners[k] = positions[triangles[t][k]];
    const auto& [a, b, c] = ball.corners;
    ball.center = (a + b + c) / 3.0;
    for (const Vec3d& corner : ball.corners)
      ball.radius = std::max(ball.radius, length(corner - ball.center));
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax({a[axis], b[axis], c[axis]});
      ball.first[std::size_t(axis)] = -cell_of(width - least);
      ball.last[std::size_t(axis)] = cell_of(most + width);
    }
  }
  return balls;
}

/// Calls f(brick) for the bricks that contain points of a ball.
template <class F>
void for_bricks(const Ball& ball, const F& f) {
  Bricks::Coordinates first{}, last{}, at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = ball.first[axis] >> 3;  // rounds down, also below 0
    last[axis] = ball.last[axis] >> 3;
  }
  for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
    for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
      for (at[0] = first[0]; at[0] <= last[0]; ++at[0]) f(at);
}

/// `width` cells [m], never rounded below: readers count the cells in it.
float width_of(float cell, int width) {
  const double exact = double(cell) * width;
  const auto rounded = static_cast<float>(exact);
  return double(rounded) < exact ? std::nextafter(rounded, 2 * rounded) : rounded;
}

}  // namespace

NarrowBand narrow_band(std::span<const Vec3f> positions, std::span<const Triangle> triangles, float cell,
                       int width, Threads& threads) {
  check(positions, cell, width);
  NarrowBand band;
  band.cell = cell;
  band.width = width_of(cell, width);
  if (triangles.empty()) return band;
  std::vector<Vec3d> in_cells;
  in_cells.reserve(positions.size());
  for (const Vec3f& x : positions) in_cells.push_back(Vec3d(x) / double(cell));
  const std::vector<Ball> balls = balls_of(in_cells, triangles, width);
  const MeshTree tree(in_cells, triangles);
  Bricks bricks;
  bricks.clear();
  for (const Ball& ball : balls)
    for_bricks(ball, [&](const Bricks::Coordinates& at) { bricks.add(at, false); });
  bricks.sort();
  // The triangles near each brick, ascending.
  const Lists<std::uint32_t> near(bricks.size(), [&](const auto& add) {
    for (std::uint32_t t = 0; t < balls.size(); ++t)
      for_bricks(balls[t], [&](const Bricks::Coordinates& at) { add(bricks.find(at), t); });
  });

  band.bricks.resize(bricks.size());
  threads.for_each(band.bricks.size(), 1, [&](std::size_t begin, std::size_t end) {
    BrickSearch search(balls, tree, band, width);
    for (std::size_t b = begin; b < end; ++b) {
      for (std::size_t axis = 0; axis < 3; ++axis) band.bricks[b].first[axis] = bricks.at(b)[axis] * side;
      search.fill(near[b], band.bricks[b]);
    }
  });
  std::erase_if(band.bricks, [](const NarrowBand::Brick& brick) {
    return std::all_of(brick.band.begin(), brick.band.end(), [](std::uint64_t bits) { return bits == 0; });
  });
  return band;
}

}  // namespace souple
