#include "souple/collision/signed_distance_field.h"

#include "souple/collision/signed_distance_grid.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

struct Sample {
  double value;
  Vec3d gradient;  // per cell
};

double between(double a, double b, double s) {
  return a + (b - a) * s;
}

// f(x, y, z) = sum over the cell's corners of value times the three weights. The gradient is the derivative
// of f.
Sample trilinear(const float* corner, std::size_t row, std::size_t layer, const Vec3d& s) {
  double f[2][2][2];  // [z][y][x]
  for (std::size_t z = 0; z < 2; ++z)
    for (std::size_t y = 0; y < 2; ++y)
      for (std::size_t x = 0; x < 2; ++x) f[z][y][x] = double(corner[z * layer + y * row + x]);
  double along[2][2], slope[2][2];  // [z][y]
  for (int z = 0; z < 2; ++z) {
    for (int y = 0; y < 2; ++y) {
      along[z][y] = between(f[z][y][0], f[z][y][1], s.x);
      slope[z][y] = f[z][y][1] - f[z][y][0];
    }
  }
  const double low = between(along[0][0], along[0][1], s.y), high = between(along[1][0], along[1][1], s.y);
  return {between(low, high, s.z),
          {between(between(slope[0][0], slope[0][1], s.y), between(slope[1][0], slope[1][1], s.y), s.z),
           between(along[0][1] - along[0][0], along[1][1] - along[1][0], s.z), high - low}};
}

Vec3d unit(const Vec3d& gradient) {
  const double l = length(gradient);
  return l > 1e-9 ? gradient / l : Vec3d{0, 1, 0};
}

}  // namespace

SurfaceDistance SignedDistanceField::Grid::inside(const Vec3d& cells) const {
  int block[3], cell[3];
  Vec3d in_block, in_cell;
  for (int k = 0; k < 3; ++k) {
    block[k] = min(static_cast<int>(cells[k]) / block_cells, blocks[static_cast<std::size_t>(k)] - 1);
    in_block[k] = cells[k] - double(block[k] * block_cells);
    cell[k] = min(static_cast<int>(in_block[k]), block_cells - 1);
    in_cell[k] = in_block[k] - double(cell[k]);
  }
  const std::int32_t at = slot[block_index(block[0], block[1], block[2])];
  Sample sample;
  if (at == coarse_only) {
    const auto row = static_cast<std::size_t>(blocks[0] + 1);
    sample = trilinear(&corners[corner_index(block[0], block[1], block[2])], row,
                       row * static_cast<std::size_t>(blocks[1] + 1), in_block / block_cells);
  } else {
    constexpr std::size_t row = block_side, layer = row * row;
    const std::size_t first = static_cast<std::size_t>(cell[2]) * layer +
                              static_cast<std::size_t>(cell[1]) * row + static_cast<std::size_t>(cell[0]);
    sample = trilinear(&points[static_cast<std::size_t>(at) * block_points + first], row, layer, in_cell);
  }
  return {sample.value, unit(sample.gradient)};
}

Vec3d SignedDistanceField::Grid::clamped(const Vec3d& cells) const {
  Vec3d result;
  for (int k = 0; k < 3; ++k) {
    const double most = double(blocks[static_cast<std::size_t>(k)] * block_cells);
    result[k] = cells[k] >= 0 ? min(cells[k], most) : 0.0;  // 0 for NaN
  }
  return result;
}

// The segment from a point p outside the grid to its nearest point q on the surface enters the grid's box at
// a point c. Then q is the point nearest to c as well: q = c - n(c) d(c). A guess of c gives q, and q gives a
// better c.
SurfaceDistance SignedDistanceField::at(const Vec3d& point) const {
  const Grid& grid = *grid_;
  const Vec3d cells = (point - grid.origin) / grid.spacing;
  Vec3d c = grid.clamped(cells);
  if (c == cells) return grid.inside(c);
  Vec3d towards;
  double least = never;
  for (int guess = 0; guess < 3; ++guess) {
    const SurfaceDistance surface = grid.inside(c);
    const Vec3d q = c - surface.normal * (surface.distance / grid.spacing);
    const Vec3d offset = cells - q;
    if (!(length(offset) < least)) break;
    least = length(offset);
    towards = offset;
    double part = 1;  // of the segment from q to p that is inside the box
    for (int k = 0; k < 3; ++k) {
      const double to_side =
          (offset[k] > 0 ? double(grid.blocks[static_cast<std::size_t>(k)] * Grid::block_cells) : 0.0) - q[k];
      if (abs(offset[k]) > abs(to_side)) part = min(part, to_side / offset[k]);
    }
    c = grid.clamped(q + offset * part);
  }
  return {least * grid.spacing, unit(towards)};
}

// Sphere tracing (Hart 1996) in the interpolant, then bisection. Steps are shorter than the distance because
// the interpolant's slope may slightly exceed 1.
double SignedDistanceField::ray(const Vec3d& origin, const Vec3d& d) const {
  double enter = 0, leave = never;
  for (int k = 0; k < 3; ++k) {
    const double margin = spacing();
    const double a = lo()[k] - margin - origin[k], b = hi()[k] + margin - origin[k];
    if (d[k] == 0) {
      if (a > 0 || b < 0) return never;
      continue;
    }
    enter = max(enter, min(a / d[k], b / d[k]));
    leave = min(leave, max(a / d[k], b / d[k]));
  }
  double outside = enter;
  for (double s = enter; s <= leave;) {
    const double distance = at(origin + d * s).distance;
    if (distance <= 0) {
      double in = s;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (outside + in);
        (at(origin + d * middle).distance > 0 ? outside : in) = middle;
      }
      return in;
    }
    outside = s;
    s += max(0.8 * distance, 0.02 * spacing());
  }
  return never;
}

double SignedDistanceField::spacing() const {
  return grid_->spacing;
}
Vec3d SignedDistanceField::lo() const {
  return grid_->lo;
}
Vec3d SignedDistanceField::hi() const {
  return grid_->hi;
}
const std::vector<Vec3d>& SignedDistanceField::positions() const {
  return grid_->mesh_positions;
}
const std::vector<Triangle>& SignedDistanceField::triangles() const {
  return grid_->mesh_triangles;
}
const std::vector<std::string>& SignedDistanceField::sentences() const {
  return grid_->sentences;
}
std::size_t SignedDistanceField::bytes() const {
  if (!grid_) return 0;
  return sizeof(Grid) +
         bytes_of(grid_->corners, grid_->slot, grid_->points, grid_->mesh_positions, grid_->mesh_triangles);
}

}  // namespace souple
