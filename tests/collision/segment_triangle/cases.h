#pragma once

#include "souple/collision/segment_triangle/segment_triangle.h"
#include "tests/collision/random.h"

#include <cmath>
#include <limits>

namespace souple::test {

template <class T>
struct Case {
  Segment<T> segment;
  Corners<T> corners;
};

/// Segments and triangles: typical ones and difficult ones.
class Cases {
 public:
  static constexpr int kinds = 12;
  explicit Cases(std::uint64_t seed) : random_(seed) {}

  /// `kind` in [0, kinds); the numbers are rounded to T.
  template <class T>
  Case<T> make(int kind) {
    corners_ = {random_.point(-1, 1), random_.point(-1, 1), random_.point(-1, 1)};
    origin_ = random_.point(-2, 2), max_t_ = 1;
    aim(random_.point(-2, 2), 1);
    change(kind);
    return {{Vec3<T>(origin_), Vec3<T>(direction_), static_cast<T>(max_t_)},
            {Vec3<T>(corners_.a), Vec3<T>(corners_.b), Vec3<T>(corners_.c)}};
  }

 private:
  void change(int kind) {
    switch (kind) {
      case 0:  // anywhere
        break;
      case 1:  // through the inside
        aim(inside(), random_.uniform(0.2, 3));
        break;
      case 2:  // through an edge, nearly
        aim(on_edge(), 2);
        break;
      case 3:  // through a corner, nearly
        aim(corners_.a, 2);
        break;
      case 4:  // ends at the plane
        aim(inside(), 1 + small() * random_.uniform(-1, 1));
        break;
      case 5:  // parallel to the plane, and in it
        origin_ = inside() + normal() * (random_.uniform(0, 1) < 0.5 ? 0 : random_.uniform(-1, 1));
        direction_ = (corners_.b - corners_.a) * random_.uniform(-2, 2) +
                     (corners_.c - corners_.a) * random_.uniform(-2, 2);
        break;
      case 6:  // nearly parallel
        origin_ = inside() + normal() * (small() * random_.uniform(-1, 1)) + (corners_.b - corners_.c) * 3.0;
        aim(inside(), 2);
        break;
      case 7:  // a sliver
        corners_.c = on_edge() + random_.point(-1, 1) * small();
        aim(inside(), 2);
        break;
      case 8:  // a needle
        corners_.c = corners_.b + random_.point(-1, 1) * small();
        aim(inside() + random_.point(-1, 1) * small(), 2);
        break;
      case 9:  // tiny or huge, hit or just missed
        aim(inside() + random_.point(-1, 1) * 0.1, 2);
        scale(std::pow(10, random_.uniform(-9, 9)));
        break;
      case 10:  // small and far away
        small_and_far();
        break;
      case 11:  // a ray
        aim(inside() + random_.point(-0.5, 0.5), random_.uniform(-1, 1));
        max_t_ = std::numeric_limits<double>::infinity();
        break;
      default:
        break;
    }
  }
  void small_and_far() {
    const Vec3d where = random_.point(-1, 1) * 20.0;
    for (Vec3d* corner : {&corners_.a, &corners_.b, &corners_.c}) *corner = *corner * 0.1 + where;
    aim(inside() + random_.point(-1, 1) * 0.1, 2);
  }
  /// Sets the direction so that the segment passes `target` at t = 1 / times.
  void aim(const Vec3d& target, double times) { direction_ = (target - origin_) * times; }
  void scale(double factor) {
    for (Vec3d* v : {&corners_.a, &corners_.b, &corners_.c, &origin_, &direction_}) *v *= factor;
  }
  double small() { return std::pow(10, random_.uniform(-8, -1)); }
  Vec3d normal() const { return cross(corners_.b - corners_.a, corners_.c - corners_.a); }
  Vec3d on_edge() {
    const double part = random_.uniform(0, 1);
    return corners_.a * (1 - part) + corners_.b * part;
  }
  Vec3d inside() {
    const double u = random_.uniform(0, 1), v = random_.uniform(0, 1 - u);
    return corners_.a * (1 - u - v) + corners_.b * u + corners_.c * v;
  }

  Random random_;
  Corners<double> corners_{};
  Vec3d origin_, direction_;
  double max_t_ = 1;
};

}  // namespace souple::test
