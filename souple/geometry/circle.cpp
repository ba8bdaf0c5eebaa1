#include "souple/geometry/circle.h"

#include "souple/math/scalar.h"

#include <utility>

namespace souple {
namespace {

// sin and cos of t in [0, pi/4] by Taylor series; the first omitted term is below 1e-18.
double small_sine(double t) {
  const double s = t * t;
  double sum = 1;
  for (int i = 18; i >= 2; i -= 2) sum = 1 - s / double(i * (i + 1)) * sum;
  return t * sum;
}

double small_cosine(double t) {
  const double s = t * t;
  double sum = 1;
  for (int i = 17; i >= 1; i -= 2) sum = 1 - s / double(i * (i + 1)) * sum;
  return sum;
}

}  // namespace

CirclePoint circle_point(std::int64_t k, std::int64_t n) {
  // The angle in eighths of a turn: 8 k / n = octant + rest / n, mirrored so that the series argument is in
  // [0, pi/4].
  const std::int64_t eighths = 8 * (k % n);
  const std::int64_t octant = eighths / n;
  const std::int64_t rest = eighths % n;
  const bool mirrored = octant % 2 != 0;
  const double t = pi / 4 * (double(mirrored ? n - rest : rest) / double(n));
  CirclePoint p{small_cosine(t), small_sine(t)};
  if (mirrored && rest == 0) p.sine = p.cosine;  // exactly on the diagonal
  if (octant == 1 || octant == 2 || octant == 5 || octant == 6) std::swap(p.cosine, p.sine);
  if (octant >= 2 && octant <= 5) p.cosine = 0 - p.cosine;
  if (octant >= 4) p.sine = 0 - p.sine;
  return p;
}

}  // namespace souple
