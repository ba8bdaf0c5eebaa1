#include "souple/host/placement.h"

#include "souple/error.h"

#include <cmath>
#include <string>

#include <fmt/core.h>

namespace souple::host {

namespace {

constexpr double flat = 1e-9;      // volume of the columns over the product of their lengths
constexpr double rounding = 1e-5;  // error of floats after a few multiplications

Vec3d column_of(const float* matrix, std::size_t column) {
  const float* c = matrix + 4 * column;
  return Vec3d(Vec3f(c[0], c[1], c[2]));
}

}  // namespace

Placement Placement::of(const float* matrix, const char* name) {
  Placement placement;
  if (matrix == nullptr) return placement;
  for (int i = 0; i < 16; ++i) {
    if (!std::isfinite(matrix[i])) throw Error(fmt::format("{}: entry {} is not finite", name, i));
    if (i % 4 == 3 && std::abs(matrix[i] - (i == 15 ? 1.0 : 0.0)) > rounding)
      throw Error(std::string(name) +
                  ": its last row is not (0, 0, 0, 1); expected a column-major matrix "
                  "without perspective");
  }
  placement.linear_ = {column_of(matrix, 0), column_of(matrix, 1), column_of(matrix, 2)};
  placement.translation_ = column_of(matrix, 3);
  const Vec3d* columns = placement.linear_.column;
  const double volume = determinant(placement.linear_);
  if (!(std::abs(volume) > flat * length(columns[0]) * length(columns[1]) * length(columns[2])))
    throw Error(std::string(name) + ": it makes the mesh flat; expected a matrix that can be inverted");
  placement.inverse_ = inverse(placement.linear_);
  placement.mirrors_ = volume < 0;
  return placement;
}

}  // namespace souple::host
