#include "souple/geometry/polyline.h"

namespace souple {

double polyline_length(std::span<const Vec3d> points) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) sum += length(points[i + 1] - points[i]);
  return sum;
}

std::vector<Vec3d> resample_polyline(std::span<const Vec3d> points, std::uint32_t segments) {
  const double step = polyline_length(points) / segments;
  std::vector<Vec3d> result{points.front()};
  std::size_t corner = 0;
  double passed = 0;  // length before points[corner]
  for (std::uint32_t k = 1; k < segments; ++k) {
    const double goal = step * k;
    double piece = length(points[corner + 1] - points[corner]);
    while (passed + piece < goal && corner + 2 < points.size()) {
      passed += piece;
      ++corner;
      piece = length(points[corner + 1] - points[corner]);
    }
    const double along = piece > 0 ? (goal - passed) / piece : 0;
    result.push_back(points[corner] + (points[corner + 1] - points[corner]) * along);
  }
  result.push_back(points.back());
  return result;
}

}  // namespace souple
