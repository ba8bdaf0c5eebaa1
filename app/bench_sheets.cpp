#include "app/bench_sheets.h"

#include "souple/geometry/builders.h"
#include "souple/math/quaternion.h"

#include <algorithm>
#include <cmath>

namespace souple::app {

namespace {

constexpr double edge = 0.02;          // m
constexpr int largest_side = 50;       // vertices along a side of a sheet
constexpr double fold = 0.25;          // m, between folds
constexpr double layers_apart = 0.02;  // m
constexpr double ripple = 0.03;        // m, amplitude
constexpr double ripple_speed = 2;     // rad/s
constexpr double drift = 0.05;         // m, amplitude of a sheet's motion about its center
constexpr double packing = 0.85;       // distance of sheet centers over a sheet's width

int side_of(int triangles) {
  const int side = static_cast<int>(std::lround(std::sqrt(triangles / 2.0))) + 1;
  return std::clamp(side, 2, largest_side);
}

/// Hash of sheet and `seed`, as a number in [-1, 1).
double sheet_random(std::size_t sheet, unsigned seed) {
  std::uint32_t hash = static_cast<std::uint32_t>(sheet) * 2654435769u + seed * 0x9e3779b9u;
  hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
  hash = (hash ^ hash >> 12) * 0x297a2d39u;
  return double(hash ^ hash >> 15) / 2147483648.0 - 1;
}

Vec3d sheet_random_vector(std::size_t sheet, unsigned seed) {
  return {sheet_random(sheet, seed), sheet_random(sheet, seed + 1), sheet_random(sheet, seed + 2)};
}

/// A sheet folded back and forth along x, its layers one above the other.
Vec3d folded(const Vec3d& flat) {
  const double along = flat.x / fold, layer = std::floor(along), part = along - layer;
  const bool back = std::fmod(layer, 2.0) != 0;
  return {fold * (back ? 1 - part : part) - fold / 2, layers_apart * along, flat.z};
}

Vec3d turned(const Vec3d& x, const Vec3d& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return x * c + cross(axis, x) * s + axis * (dot(axis, x) * (1 - c));
}

}  // namespace

Sheets::Sheets(int triangles) {
  const int side = side_of(triangles);
  const TriangleMesh mesh = grid(side, side, edge * (side - 1));
  flat_ = mesh.positions;
  triangles_ = mesh.triangles;
  const auto each = static_cast<double>(triangles_.size());
  const auto sheets = static_cast<std::uint32_t>(std::max(1.0, std::round(triangles / each)));
  const auto vertices = static_cast<std::uint32_t>(flat_.size());
  for (std::uint32_t s = 0; s < sheets; ++s) elements_.add_triangles(triangles_, s * vertices, s);
  positions_.resize(std::size_t{sheets} * vertices);
  motion_.resize(positions_.size());
  boxes_.resize(positions_.size());
  move_to(0);
}

Vec3d Sheets::position(std::size_t sheet, const Vec3d& flat, double time) const {
  const Vec3d phase = sheet_random_vector(sheet, 0) * pi;
  Vec3d x = folded(flat);
  x.y += ripple * std::sin(11 * x.x + 7 * x.z + phase.x + ripple_speed * time) +
         0.3 * ripple * std::sin(23 * x.z - 17 * x.x + phase.y - 1.7 * ripple_speed * time);
  x = turned(x, normalized(sheet_random_vector(sheet, 3)), phase.z + 0.7 * time);
  const auto columns = static_cast<std::size_t>(std::ceil(std::cbrt(double(sheets()))));
  const double width = packing * (flat_.back().z - flat_.front().z);
  const std::size_t column = sheet % columns, row = sheet / columns % columns,
                    floor = sheet / columns / columns;
  const Vec3d center = Vec3d{double(column), double(row), double(floor)} * (0.5 * width);
  return x + center + sheet_random_vector(sheet, 6) * (drift * std::sin(3 * time + phase.y));
}

void Sheets::move_to(int step) {
  const double time = step * dt;
  const std::size_t n = flat_.size();
  constexpr auto half = static_cast<float>(thickness / 2);
  for (std::size_t s = 0; s < sheets(); ++s)
    for (std::size_t v = 0; v < n; ++v) {
      const Vec3f x(position(s, flat_[v], time)), next(position(s, flat_[v], time + dt));
      const std::size_t i = s * n + v;
      positions_[i] = {x.x, x.y, x.z, 1};
      motion_[i] = next - x;
      const Bounds swept = united({x, x}, {next, next});
      boxes_[i] = {swept.lo - Vec3f{half, half, half}, swept.hi + Vec3f{half, half, half}};
    }
}

}  // namespace souple::app
