#pragma once

#include "souple/collision/segment_triangle/segment_triangle.h"

namespace souple {

/// Woop, Benthin and Wald, Watertight ray/triangle intersection, JCGT 2 (1), 2013. No ray passes between two triangles
/// that share an edge, nor through the corner where many meet.
///
/// Let z be the axis in which d is largest, and x and y the two axes after it. Each corner is sheared
/// independently, so that the segment is along z from the origin (section 3.1):
///
///   x' = x - (d_x / d_z) z,   y' = y - (d_y / d_z) z,   z' = z / d_z.
///
/// The test is then whether the origin of the plane is in the triangle of the (x', y') (section 3.2):
///
///   U = b_x c_y - b_y c_x,   V = c_x a_y - c_y a_x,   W = a_x b_y - a_y b_x,
///   t = (U a_z + V b_z + W c_z) / (U + V + W).
///
/// Every triangle rounds a shared corner to the same x' and y'. So the sheared triangles are a mesh without
/// holes in the plane, as long as no U has a wrong sign. None has: rounding keeps the order of the two
/// products, so their difference has the right sign or is zero. Where it is zero, the products' rounding
/// errors, which are numbers of the same type, are subtracted instead. (Deviation: the paper computes these
/// cases in double, section 3.3; packs have no double.) An origin within rounding of the surface may be on
/// either side of it.
struct Watertight {
  template <class T, int along>
  class Prepared {
   public:
    explicit Prepared(const Segment<T>& segment) : origin_(in_order(segment.origin)), max_t_(segment.max_t) {
      const Vec3<T> d = in_order(segment.direction);
      const auto has_length = abs(d.z) > T(0);
      const T z = select(has_length, d.z, T(1));
      shear_x_ = d.x / z, shear_y_ = d.y / z, shear_z_ = T(1) / z;
      max_t_ = select(has_length, segment.max_t, T(-1));  // t is never in [0, -1]
      sign_ = select(d.z < T(0), T(-1), T(1));
    }

    Crossing<T> operator()(const Corners<T>& corners) const {
      const Vec3<T> a = sheared(corners.a), b = sheared(corners.b), c = sheared(corners.c);
      const Vec3<T> area = areas(a, b, c);
      const T sum = area.x + area.y + area.z;
      const T height = area.x * a.z + area.y * b.z + area.z * c.z;
      return detail::crossing_of_volumes(area, sum, height, sum * sign_, max_t_);
    }

   private:
    static Vec3<T> in_order(const Vec3<T>& v) {
      if constexpr (along == 0) return {v.y, v.z, v.x};
      if constexpr (along == 1) return {v.z, v.x, v.y};
      return v;
    }
    Vec3<T> sheared(const Vec3<T>& corner) const {
      const Vec3<T> r = in_order(corner) - origin_;
      return {r.x - shear_x_ * r.z, r.y - shear_y_ * r.z, r.z * shear_z_};
    }
    static Vec3<T> areas(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
      const Vec3<T> area{b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x};
      const auto zero = [](T value) { return abs(value) <= T(0); };
      const auto x = zero(area.x), y = zero(area.y), z = zero(area.z);
      if (!any_lane(x || y || z)) return area;
      return {select(x, difference_of_errors(b.x, c.y, b.y, c.x), area.x),
              select(y, difference_of_errors(c.x, a.y, c.y, a.x), area.y),
              select(z, difference_of_errors(a.x, b.y, a.y, b.x), area.z)};
    }
    /// p q - r s where both products round to the same number.
    static T difference_of_errors(T p, T q, T r, T s) { return product_error(p, q) - product_error(r, s); }
    /// p q minus its rounded value: Dekker, A floating-point technique for extending the available precision,
    /// 1971, section 5.
    static T product_error(T p, T q) {
      const Halves x(p), y(q);
      return x.low * y.low - (((p * q - x.high * y.high) - x.low * y.high) - x.high * y.low);
    }
    /// A number split into two with half its digits each; their products are exact.
    struct Halves {
      T high, low;
      explicit Halves(T whole) {
        constexpr int half = (std::numeric_limits<ScalarOf<T>>::digits + 1) / 2;
        const T split = whole * T(static_cast<ScalarOf<T>>((1 << half) + 1));
        high = split - (split - whole);
        low = whole - high;
      }
    };

    Vec3<T> origin_;
    T shear_x_, shear_y_, shear_z_, sign_, max_t_;
  };

  template <class T, class Function>
  static auto prepare(const Segment<ScalarOf<T>>& segment, const Function& f) {
    // No abs: this translation unit, compiled for one instruction set, must not emit scalar functions that
    // others share.
    const auto squared = [](ScalarOf<T> a) { return a * a; };
    const auto x = squared(segment.direction.x), y = squared(segment.direction.y),
               z = squared(segment.direction.z);
    if (x > y && x > z) return f(Prepared<T, 0>(broadcast<T>(segment)));
    if (y > z) return f(Prepared<T, 1>(broadcast<T>(segment)));
    return f(Prepared<T, 2>(broadcast<T>(segment)));
  }
};

}  // namespace souple
