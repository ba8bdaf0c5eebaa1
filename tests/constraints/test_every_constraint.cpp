#include "souple/math/dual.h"
#include "souple/math/quaternion.h"
#include "souple/solver/kernels/projection.h"
#include "tests/constraints/examples.h"

#include <vector>

#include <gtest/gtest.h>

// Properties of all constraint kinds that Souple ships.

namespace souple::test_constraints_every_constraint {

template <class Kind, class T>
struct Evaluation {
  T C[rows_of<Kind>];
  Vec3<T> gradient[rows_of<Kind>][Kind::arity];
};

template <class Kind, class T>
Evaluation<Kind, T> evaluate(const std::array<Vec3<T>, Kind::arity>& x, const ParamsOf<Kind>& params) {
  Evaluation<Kind, T> result;
  Vec3<T> points[Kind::arity];
  for (std::size_t i = 0; i < Kind::arity; ++i) points[i] = x[i];
  evaluate_rows<Kind, T>(points, converted<Kind, T>(params), result.C, result.gradient);
  return result;
}

/// Shape of the example with points moved by up to `amount` along each axis.
template <class Kind>
Points<Kind> perturbed(double amount, std::uint64_t seed) {
  Random random(seed);
  Points<Kind> x = Example<Kind>::points();
  for (Vec3d& point : x) point += random.vector() * amount;
  return x;
}

/// Correction of one projection in float, computed as SetProjector does, relative to the first point.
template <class Kind>
Points<Kind> correction(const Points<Kind>& x, const ParamsOf<Kind>& params,
                        const std::vector<double>& masses) {
  ProjectionInput<Kind, float> in{};
  for (std::size_t i = 0; i < Kind::arity; ++i) {
    in.x[i] = Vec3f(has_origin<Kind> ? x[i] : x[i] - x[0]);
    in.inverse_mass[i] = static_cast<float>(1 / masses[i]);
  }
  Vec3f dx[Kind::arity];
  float dlambda[rows_of<Kind>];
  project_constraint<Kind, float>(in, params, dx, dlambda);
  Points<Kind> result;
  for (std::size_t i = 0; i < Kind::arity; ++i) result[i] = Vec3d(dx[i]);
  return result;
}

std::vector<double> uneven_masses(std::size_t count) {
  std::vector<double> masses;
  for (std::size_t i = 0; i < count; ++i) masses.push_back(0.5 + 0.7 * static_cast<double>(i));
  return masses;
}

/// Largest |C|; for an inequality, the largest violation.
template <class Kind>
double violation(const Points<Kind>& x, const ParamsOf<Kind>& params) {
  double worst = 0;
  for (const double C : evaluate<Kind, double>(x, params).C)
    worst = std::fmax(worst, Kind::sense == Sense::non_negative ? -C : std::fabs(C));
  return worst;
}

template <class Kind>
bool all_finite(const Points<Kind>& x) {
  for (const Vec3d& v : x)
    if (!is_finite(v)) return false;
  return true;
}

/// The example scaled to a size in meters, with the parameters for that size.
template <class Kind>
struct Sized {
  Points<Kind> rest = Example<Kind>::points();
  ParamsOf<Kind> params;
  explicit Sized(double size) {
    for (Vec3d& x : rest) x *= size;
    params = Example<Kind>::params(rest);
  }
};

constexpr double sizes[] = {1e-3, 1e-2, 0.1, 1, 10, 100};

template <class Kind>
class EveryConstraintTest : public testing::Test {};

template <class Tuple>
struct AsTypes;
template <class... Kinds>
struct AsTypes<std::tuple<Kinds...>> {
  using Types = testing::Types<Kinds...>;
};
struct KindName {
  template <class Kind>
  static std::string GetName(int) {  // NOLINT(readability-identifier-naming): GoogleTest calls it
    return Kind::name;
  }
};
TYPED_TEST_SUITE(EveryConstraintTest, AsTypes<EveryConstraint>::Types, KindName);

TYPED_TEST(EveryConstraintTest, GradientIsTheDerivative) {
  using Kind = TypeParam;
  const ParamsOf<Kind> params = Example<Kind>::params(Example<Kind>::points());
  for (const double amount : {1e-3, 0.05, 0.3, 1.0, 3.0}) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const Points<Kind> x = perturbed<Kind>(amount, seed);
      const auto expected = evaluate<Kind, double>(x, params);
      for (std::size_t i = 0; i < Kind::arity; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          std::array<Vec3<Duald>, Kind::arity> dual;
          for (std::size_t k = 0; k < Kind::arity; ++k) dual[k] = Vec3<Duald>(x[k]);
          dual[i][axis].derivative = 1;
          const auto actual = evaluate<Kind, Duald>(dual, params);
          for (int r = 0; r < rows_of<Kind>; ++r) {
            double size = 0;
            for (const Vec3d& g : expected.gradient[r]) size = std::fmax(size, length(g));
            ASSERT_NEAR(actual.C[r].derivative, expected.gradient[r][i][axis], 1e-8 * size)
                << "row " << r << " point " << i << " axis " << axis << " moved by " << amount << " seed "
                << seed;
          }
        }
      }
    }
  }
}

TYPED_TEST(EveryConstraintTest, DoesNotDependOnWhereAndHowItLies) {
  using Kind = TypeParam;
  const ParamsOf<Kind> params = Example<Kind>::params(Example<Kind>::points());
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Points<Kind> x = perturbed<Kind>(0.4, seed);
    Random random(seed + 1000);
    const Quatd turn = Quatd::from_euler_xyz(random.vector() * pi);
    // Positions relative to a target may only rotate about it.
    const Vec3d shift = has_origin<Kind> ? Vec3d{} : random.vector() * 5;
    Points<Kind> moved;
    for (std::size_t i = 0; i < Kind::arity; ++i) moved[i] = rotate(turn, x[i]) + shift;
    const auto here = evaluate<Kind, double>(x, params);
    const auto there = evaluate<Kind, double>(moved, params);
    for (int r = 0; r < rows_of<Kind>; ++r) {
      EXPECT_NEAR(here.C[r], there.C[r], 1e-12);
      for (int i = 0; i < Kind::arity; ++i)
        EXPECT_LT(length(rotate(turn, here.gradient[r][i]) - there.gradient[r][i]),
                  1e-10 * (1 + length(here.gradient[r][i])));
    }
  }
}

TYPED_TEST(EveryConstraintTest, ProjectionKeepsMomentum) {
  using Kind = TypeParam;
  const std::vector<double> masses = uneven_masses(Kind::arity);
  for (const double size : sizes) {
    const Sized<Kind> example(size);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      Points<Kind> x = perturbed<Kind>(0.4, seed);
      for (Vec3d& point : x) point *= size;
      const Points<Kind> dx = correction<Kind>(x, example.params, masses);
      Vec3d linear, angular;
      double scale = 0, farthest = 0;
      for (std::size_t i = 0; i < Kind::arity; ++i) {
        const Vec3d arm = has_origin<Kind> ? x[i] : x[i] - x[0];
        linear += dx[i] * masses[i];
        angular += cross(arm, dx[i] * masses[i]);
        scale += masses[i] * length(dx[i]);
        farthest = std::fmax(farthest, length(arm));
      }
      // A target takes up linear momentum, but no angular momentum about itself.
      if (!has_origin<Kind>) {
        EXPECT_LE(length(linear), 2e-6 * scale) << "size " << size << " seed " << seed;
      }
      EXPECT_LE(length(angular), 1e-5 * scale * farthest) << "size " << size << " seed " << seed;
    }
  }
}

/// Velocity changes of one damping in float, as SetProjector computes them. A compliance of 0, or one as large
/// as the damping's share of the denominator.
template <class Kind>
Points<Kind> damping(const Points<Kind>& x, const ParamsOf<Kind>& params, const std::vector<double>& masses,
                     const Points<Kind>& velocity, bool compliant) {
  DampingInput<Kind, float> in{};
  for (std::size_t i = 0; i < Kind::arity; ++i) {
    in.constraint.x[i] = Vec3f(has_origin<Kind> ? x[i] : x[i] - x[0]);
    in.constraint.inverse_mass[i] = static_cast<float>(1 / masses[i]);
    in.velocity[i] = Vec3f(velocity[i]);
  }
  if (compliant)
    for (int r = 0; r < rows_of<Kind>; ++r) {
      double sum = 0;
      for (std::size_t i = 0; i < Kind::arity; ++i)
        sum += length_squared(evaluate<Kind, double>(x, params).gradient[r][i]) / masses[i];
      in.constraint.alpha[r * (r + 1) / 2 + r] = static_cast<float>(3 * sum);
    }
  in.gamma = 3;
  Vec3f dv[Kind::arity];
  damp_constraint<Kind, float>(in, params, dv);
  Points<Kind> result;
  for (std::size_t i = 0; i < Kind::arity; ++i) result[i] = Vec3d(dv[i]);
  return result;
}

// Kelvin-Voigt damping keeps momentum, takes energy, and leaves a rigid motion alone.
TYPED_TEST(EveryConstraintTest, DampingKeepsMomentumAndTakesEnergy) {
  using Kind = TypeParam;
  const std::vector<double> masses = uneven_masses(Kind::arity);
  double most_taken = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Points<Kind> x = perturbed<Kind>(0.4, seed);
    Random random(seed + 1000);
    const Vec3d drift = random.vector(), spin = random.vector();
    Points<Kind> v, rigid;
    for (std::size_t i = 0; i < Kind::arity; ++i) {
      v[i] = random.vector();
      rigid[i] = has_origin<Kind> ? cross(spin, x[i]) : drift + cross(spin, x[i]);
    }
    const ParamsOf<Kind> params = Sized<Kind>(1).params;
    const Points<Kind> dv = damping<Kind>(x, params, masses, v, seed % 2 == 0);
    const Points<Kind> none = damping<Kind>(x, params, masses, rigid, seed % 2 == 0);
    Vec3d linear, angular;
    double before = 0, after = 0;
    for (std::size_t i = 0; i < Kind::arity; ++i) {
      linear += dv[i] * masses[i];
      angular += cross(has_origin<Kind> ? x[i] : x[i] - x[0], dv[i] * masses[i]);
      before += masses[i] * length_squared(v[i]);
      after += masses[i] * length_squared(v[i] + dv[i]);
      EXPECT_LT(length(none[i]), 2e-4) << "seed " << seed;
    }
    if (!has_origin<Kind>) {
      EXPECT_LT(length(linear), 2e-5) << "seed " << seed;
    }
    EXPECT_LT(length(angular), 1e-4) << "seed " << seed;
    EXPECT_LT(after, before * (1 + 1e-5)) << "seed " << seed;
    most_taken = std::fmax(most_taken, 1 - after / before);
  }
  EXPECT_GT(most_taken, 0.1);
}

// No absolute threshold: shapes of a millimeter, a meter and a hundred meters behave alike.
TYPED_TEST(EveryConstraintTest, ActsAlikeAtEverySize) {
  using Kind = TypeParam;
  const std::vector<double> masses = uneven_masses(Kind::arity);
  const Sized<Kind> meter(1);
  int moved = 0;
  for (const double size : sizes) {
    const Sized<Kind> example(size);
    for (const double amount : {0.01, 0.1, 0.4}) {
      for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Points<Kind> x = perturbed<Kind>(amount, seed);
        Points<Kind> scaled = x;
        for (Vec3d& point : scaled) point *= size;
        // The smallest gradient limits the accuracy in float, hence a bound relative to the largest
        // correction.
        const Points<Kind> expected = correction<Kind>(x, meter.params, masses);
        const Points<Kind> actual = correction<Kind>(scaled, example.params, masses);
        double largest = 0;
        for (const Vec3d& dx : expected) largest = std::fmax(largest, length(dx));
        if (largest > 0) ++moved;
        for (std::size_t i = 0; i < Kind::arity; ++i)
          EXPECT_LT(length(actual[i] * (1 / size) - expected[i]), 1e-3 * largest + 2e-6)
              << "size " << size << " amount " << amount << " seed " << seed;
      }
    }
  }
  EXPECT_GT(moved, 50);
}

TYPED_TEST(EveryConstraintTest, RepeatedProjectionSatisfiesIt) {
  using Kind = TypeParam;
  const std::vector<double> masses = uneven_masses(Kind::arity);
  for (const double size : sizes) {
    const Sized<Kind> example(size);
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      Points<Kind> x = perturbed<Kind>(0.2, seed);
      for (Vec3d& point : x) point *= size;
      const double before = violation<Kind>(x, example.params);
      for (int k = 0; k < 50; ++k) {
        const Points<Kind> dx = correction<Kind>(x, example.params, masses);
        for (std::size_t i = 0; i < Kind::arity; ++i) x[i] += dx[i];
      }
      EXPECT_LE(violation<Kind>(x, example.params), 2e-4 * before) << "size " << size << " seed " << seed;
    }
  }
}

// Coincident, collinear and coplanar points, and shapes that are folded shut or far apart. No result is NaN, and no
// correction is longer than ten times the extent of the shape and of the constraint.
TYPED_TEST(EveryConstraintTest, DegenerateShapesStayFinite) {
  using Kind = TypeParam;
  const std::vector<double> masses = uneven_masses(Kind::arity);
  for (const double size : sizes) {
    const Sized<Kind> example(size);
    std::vector<Points<Kind>> shapes;
    const Points<Kind>& rest = example.rest;
    const auto shape = [&](auto&& map) {
      Points<Kind> x = rest;
      for (Vec3d& point : x) point = map(point);
      shapes.push_back(x);
    };
    shape([](const Vec3d&) { return Vec3d{}; });
    for (const double s : {0.0, 1e-30, 1e-12, 1e-6, 1e-3}) {
      shape([s](const Vec3d& v) { return Vec3d{v.x * s, v.y * s, v.z * s}; });
      shape([s](const Vec3d& v) { return Vec3d{v.x, v.y, v.z * s}; });
      shape([s](const Vec3d& v) { return Vec3d{v.x, v.y * s, v.z * s}; });
      shape([s](const Vec3d& v) { return Vec3d{v.x * s, v.y, -v.y * s}; });
      shape([s](const Vec3d& v) { return Vec3d{v.x, v.y * s, -v.z}; });
      shape([s](const Vec3d& v) { return Vec3d{v.x, std::fabs(v.y), v.z * s}; });
    }
    shape([](const Vec3d& v) { return v * -1.0; });
    shape([](const Vec3d& v) { return v * 1e3; });
    for (std::size_t i = 0; i < Kind::arity; ++i)
      for (std::size_t k = 0; k < i; ++k) {
        shapes.push_back(rest);
        shapes.back()[i] = rest[k];
      }
    for (std::size_t n = 0; n < shapes.size(); ++n) {
      const auto at = evaluate<Kind, float>(
          [&] {
            std::array<Vec3f, Kind::arity> x;
            for (std::size_t i = 0; i < Kind::arity; ++i) x[i] = Vec3f(shapes[n][i]);
            return x;
          }(),
          example.params);
      for (int r = 0; r < rows_of<Kind>; ++r) {
        EXPECT_TRUE(std::isfinite(at.C[r])) << "shape " << n << " size " << size;
        for (const Vec3f& g : at.gradient[r]) EXPECT_TRUE(is_finite(g)) << "shape " << n << " size " << size;
      }
      const Points<Kind> dx = correction<Kind>(shapes[n], example.params, masses);
      ASSERT_TRUE(all_finite<Kind>(dx)) << "shape " << n << " size " << size;
      double extent = size;
      for (const Vec3d& v : shapes[n]) extent = std::fmax(extent, length(v));
      for (const Vec3d& v : dx) EXPECT_LT(length(v), 10 * extent) << "shape " << n << " size " << size;
    }
  }
}

}  // namespace souple::test_constraints_every_constraint
