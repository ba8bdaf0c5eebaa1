#include "souple/surface/narrow_band.h"

#include "souple/error.h"
#include "souple/surface/bricks.h"
#include "souple/surface/pseudonormals.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace souple {

namespace {

constexpr int side = NarrowBand::side;
constexpr std::size_t points = NarrowBand::brick_points;

/// A triangle in a ball around its centre, and which of the grid's points may be near to it. In cells.
struct Ball {
  Vec3d centre;
  double radius = 0;
  std::array<std::int32_t, 3> first{}, last{};
};

/// One brick at a time: which triangle is nearest to each of its points.
///
/// Of most triangles a point need not know the distance: centres c lie on triangles, so no surface is further
/// than the nearest of them, and what lies in a ball of radius r around c is no nearer than |p - c| - r. Both
/// are looked up eight points at a time, in cells from the brick's first point, with a little to spare for
/// what floats round.
class BrickSearch {
 public:
  BrickSearch(std::span<const Ball> balls, const Pseudonormals& surface, double cell, double width)
      : balls_(balls), surface_(surface), cell_(cell), width_(width) {}

  void fill(std::span<const std::uint32_t> near, NarrowBand::Brick& brick) {
    bound(near, brick.first);
    for (std::size_t i = 0; i < points; ++i) {
      bound_[i] = std::sqrt(std::min(bound_[i], static_cast<float>(width_ * width_)));
      best_[i] = width_ * cell_ * (width_ * cell_);
    }
    nearest_.fill(none);
    for (const std::uint32_t t : near) measure(t, brick.first);
    for (std::size_t i = 0; i < points; ++i) write(i, brick);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr float spare = 1e-3f;

  /// A ball as seen from a brick: which rows of points along z may be near.
  struct Seen {
    float x, y, z, radius;
    int first_x, last_x, first_y, last_y;
  };
  Seen seen(std::uint32_t t, const std::array<std::int32_t, 3>& first) const {
    const Ball& ball = balls_[t];
    const auto from = [&](std::size_t axis) { return std::max(ball.first[axis] - first[axis], 0); };
    const auto to = [&](std::size_t axis) { return std::min(ball.last[axis] - first[axis], side - 1); };
    const Vec3d c = ball.centre - Vec3d(first[0], first[1], first[2]);
    return {float(c.x), float(c.y), float(c.z), float(ball.radius * 1.00001), from(0), to(0), from(1), to(1)};
  }
  /// Calls f(first point, squared distance to the middle of the row's axis) for these rows.
  template <class F>
  static void for_rows(const Seen& ball, const F& f) {
    for (int x = ball.first_x; x <= ball.last_x; ++x) {
      for (int y = ball.first_y; y <= ball.last_y; ++y) {
        const float dx = float(x) - ball.x, dy = float(y) - ball.y;
        f(static_cast<std::size_t>((x * side + y) * side), dx * dx + dy * dy);
      }
    }
  }

  void bound(std::span<const std::uint32_t> near, const std::array<std::int32_t, 3>& first) {
    bound_.fill(1e30f);
    for (const std::uint32_t t : near) {
      const Seen ball = seen(t, first);
      for_rows(ball, [&](std::size_t row, float square) {
        float* of_row = &bound_[row];
        for (int z = 0; z < side; ++z) {
          const float dz = float(z) - ball.z, d = square + dz * dz;
          of_row[z] = d < of_row[z] ? d : of_row[z];
        }
      });
    }
  }

  void measure(std::uint32_t t, const std::array<std::int32_t, 3>& first) {
    const Seen ball = seen(t, first);
    const std::array<Vec3d, 3> x = surface_.corners(t);
    for_rows(ball, [&](std::size_t row, float square) {
      const float* of_row = &bound_[row];
      std::array<std::int32_t, side> may{};
      for (int z = 0; z < side; ++z) {
        const float dz = float(z) - ball.z, reach = of_row[z] + ball.radius + spare;
        may[static_cast<std::size_t>(z)] = square + dz * dz <= reach * reach ? 1 : 0;
      }
      std::int32_t any = 0;
      for (const std::int32_t m : may) any |= m;
      if (any == 0) return;
      for (std::size_t z = 0; z < side; ++z) {
        if (may[z] == 0) continue;
        const Vec3d p = place(row + z, first);
        const double d = length_squared(p - on_triangle(x, closest_on_triangle(p, x[0], x[1], x[2])));
        if (d >= best_[row + z]) continue;
        best_[row + z] = d;
        nearest_[row + z] = t;
      }
    });
  }

  void write(std::size_t i, NarrowBand::Brick& brick) const {
    const auto width = static_cast<float>(width_ * cell_), distance = static_cast<float>(std::sqrt(best_[i]));
    brick.distances[i] = width;
    if (nearest_[i] == none || distance >= width) return;
    const std::uint32_t t = nearest_[i];
    const std::array<Vec3d, 3> x = surface_.corners(t);
    const Vec3d p = place(i, brick.first);
    const TrianglePoint nearest = closest_on_triangle(p, x[0], x[1], x[2]);
    const double towards = dot(p - on_triangle(x, nearest), surface_.at(t, nearest));
    brick.distances[i] = towards < 0 ? -distance : distance;
    brick.band[i / 64] |= std::uint64_t{1} << i % 64;
  }

  Vec3d place(std::size_t point, const std::array<std::int32_t, 3>& first) const {
    const auto part = [&](std::size_t axis, std::size_t stride) {
      return static_cast<double>(first[axis] + static_cast<std::int32_t>(point / stride % side)) * cell_;
    };
    return {part(0, std::size_t{side} * side), part(1, side), part(2, 1)};
  }
  static Vec3d on_triangle(const std::array<Vec3d, 3>& x, const TrianglePoint& w) {
    return x[0] * w.a + x[1] * w.b + x[2] * w.c;
  }

  std::span<const Ball> balls_;
  const Pseudonormals& surface_;
  double cell_, width_;  // m, cells
  std::array<float, points> bound_;
  std::array<double, points> best_;  // squared [m^2]
  std::array<std::uint32_t, points> nearest_;
};

void check(std::span<const Vec3f> positions, float cell, int width) {
  if (!(std::isfinite(cell) && cell > 0))
    throw Error("narrow_band: cell is " + std::to_string(cell) + "; expected a finite length above 0 [m]");
  if (width < 1 || width > 100)
    throw Error("narrow_band: width is " + std::to_string(width) + "; expected 1 to 100 cells");
  constexpr double furthest = double(Bricks::limit - 32) * side;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f& x = positions[i];
    const double far = std::max({std::abs(double(x.x)), std::abs(double(x.y)), std::abs(double(x.z))});
    if (!is_finite(x) || far > furthest * double(cell))
      throw Error("narrow_band: vertex " + std::to_string(i) +
                  " is not finite, or too far from the origin for cells of " + std::to_string(cell) +
                  " m; take larger ones");
  }
}

std::vector<Ball> balls_of(const Pseudonormals& surface, double cell, double width) {
  std::vector<Ball> balls(surface.size());
  for (std::size_t t = 0; t < balls.size(); ++t) {
    std::array<Vec3d, 3> x = surface.corners(t);
    for (Vec3d& corner : x) corner = corner / cell;
    Ball& ball = balls[t];
    ball.centre = (x[0] + x[1] + x[2]) / 3;
    for (const Vec3d& corner : x) ball.radius = std::max(ball.radius, length(corner - ball.centre));
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax({x[0][axis], x[1][axis], x[2][axis]});
      ball.first[std::size_t(axis)] = static_cast<std::int32_t>(std::ceil(least - width));
      ball.last[std::size_t(axis)] = static_cast<std::int32_t>(std::floor(most + width));
    }
  }
  return balls;
}

/// Calls f(brick) for the bricks that a ball's points lie in.
template <class F>
void for_bricks(const Ball& ball, const F& f) {
  Bricks::Coordinates first{}, last{}, at{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = ball.first[axis] >> 3;  // rounds down, below 0 too
    last[axis] = ball.last[axis] >> 3;
  }
  for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
    for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
      for (at[0] = first[0]; at[0] <= last[0]; ++at[0]) f(at);
}

/// Which triangles are near each brick, ascending: those of b are triangle[first[b]] to first[b + 1].
struct Lists {
  Bricks bricks;
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> triangle;
};

Lists lists_of(std::span<const Ball> balls) {
  Lists lists;
  lists.bricks.clear();
  for (const Ball& ball : balls)
    for_bricks(ball, [&](const Bricks::Coordinates& at) { lists.bricks.add(at, false); });
  lists.bricks.sort();
  std::vector<std::size_t>& first = lists.first;
  first.assign(lists.bricks.size() + 1, 0);
  for (const Ball& ball : balls)
    for_bricks(ball, [&](const Bricks::Coordinates& at) { ++first[lists.bricks.find(at)]; });
  std::size_t sum = 0;
  for (std::size_t& of_brick : first) sum += std::exchange(of_brick, sum);
  lists.triangle.resize(sum);
  // Each ends where the next began, then all move on by one.
  for (std::size_t t = 0; t < balls.size(); ++t)
    for_bricks(balls[t], [&](const Bricks::Coordinates& at) {
      lists.triangle[first[lists.bricks.find(at)]++] = static_cast<std::uint32_t>(t);
    });
  for (std::size_t b = lists.bricks.size(); b > 0; --b) first[b] = first[b - 1];
  first[0] = 0;
  return lists;
}

}  // namespace

NarrowBand narrow_band(std::span<const Vec3f> positions, std::span<const Triangle> triangles, float cell,
                       int width, Threads& threads) {
  check(positions, cell, width);
  std::vector<Vec3d> exact;
  exact.reserve(positions.size());
  for (const Vec3f& x : positions) exact.emplace_back(x);
  const Pseudonormals surface(std::move(exact), triangles);
  const std::vector<Ball> balls = balls_of(surface, double(cell), width);
  const Lists lists = lists_of(balls);

  NarrowBand band;
  band.cell = cell;
  band.width = static_cast<float>(width) * cell;
  band.bricks.resize(lists.bricks.size());
  threads.for_each(band.bricks.size(), 1, [&](std::size_t begin, std::size_t end) {
    BrickSearch search(balls, surface, double(cell), width);
    for (std::size_t b = begin; b < end; ++b) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        band.bricks[b].first[axis] = lists.bricks.at(b)[axis] * side;
      const std::span<const std::uint32_t> all(lists.triangle);
      search.fill(all.subspan(lists.first[b], lists.first[b + 1] - lists.first[b]), band.bricks[b]);
    }
  });
  std::erase_if(band.bricks, [](const NarrowBand::Brick& brick) {
    return std::all_of(brick.band.begin(), brick.band.end(), [](std::uint64_t bits) { return bits == 0; });
  });
  return band;
}

}  // namespace souple
