#include "souple/solver/custom_constraint.h"
#include "souple/studies/make_solver.h"
#include "tests/solver/solver_scene.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <gtest/gtest.h>

namespace souple::test_solver_gauss_seidel {

using test::SolverScene;

// Mean distance of the last row of a stretched rigid sheet from its rest position after the iterations. [m]
double error_after(const SolverSettings& settings, int iterations) {
  SolverScene scene = test::sheet(16, 0.1, 0.001, 0, true);
  const double rest = scene.body.at(255).z;
  for (Vec4f& x : scene.body.position) x.z *= 1.1f;
  scene.substep.iterations = iterations;
  scene.use(settings);
  scene.solve();
  double sum = 0;
  for (std::size_t i = 240; i < 256; ++i) sum += std::fabs(scene.body.at(i).z - rest) / 16;
  return sum;
}

// Purpose of the settings: a stretched rigid sheet returns to its length with less work.
TEST(GaussSeidel, ChebyshevConvergesFaster) {
  SolverSettings plain = test::kind_of(SolverKind::gauss_seidel), chebyshev;
  chebyshev.chebyshev = 0.98f;
  EXPECT_LT(error_after(chebyshev, 64), 0.5 * error_after(plain, 64));
}
TEST(GaussSeidel, ChebyshevOfSymmetricSweepsTakesALargeRadius) {
  const SolverSettings plain = test::kind_of(SolverKind::gauss_seidel);
  SolverSettings symmetric, both;
  symmetric.sweep = both.sweep = Sweep::symmetric;
  both.chebyshev = 0.99f;
  EXPECT_LT(error_after(symmetric, 64), error_after(plain, 64));
  EXPECT_LT(error_after(both, 64), 0.3 * error_after(plain, 128));
}
TEST(Jacobi, RelaxationAndChebyshevConvergeFaster) {
  SolverSettings plain = test::kind_of(SolverKind::jacobi), relaxed = plain, chebyshev = plain;
  relaxed.relaxation = 1.8f;
  chebyshev.chebyshev = 0.99f;
  const double before = error_after(plain, 200);
  EXPECT_LT(error_after(relaxed, 200), 0.9 * before);
  EXPECT_LT(error_after(chebyshev, 200), 0.7 * before);
}

// Relaxation and Chebyshev do not change the material: they act on multipliers and positions alike.
TEST(GaussSeidel, AccelerationKeepsCompliance) {
  for (const SolverKind kind : {SolverKind::gauss_seidel, SolverKind::jacobi})
    for (const float relaxation : {0.8f, 1.5f})
      for (const float chebyshev : {0.0f, 0.7f}) {
        SolverSettings settings = test::kind_of(kind);
        settings.relaxation = relaxation;
        settings.chebyshev = chebyshev;
        settings.sweep = chebyshev > 0 ? Sweep::symmetric : Sweep::forward;
        SolverScene scene;
        for (int i = 0; i < 4; ++i) scene.add({0, -0.1 * i, 0}, i == 0 ? 0 : 0.1);
        auto& links = scene.add<Distance>();
        for (std::uint32_t i = 0; i < 3; ++i) links.add({i, i + 1}, {0.1f}, {1e-3f});
        scene.gravity = {0, -9.81f, 0};
        scene.damping = 0.9f;
        scene.substep.iterations = 40;
        scene.use(settings);
        for (int k = 0; k < 400; ++k) scene.step();
        const double expected = 1e-3 * 0.3 * 9.81;
        EXPECT_NEAR(length(scene.body.at(1)) - 0.1, expected, 3e-3 * expected)
            << make_solver(settings)->name() << ", omega " << relaxation << ", rho " << chebyshev;
      }
}

// With relaxation omega, one projection leaves (1 - omega) of the constraint's violation.
TEST(GaussSeidel, RelaxationScalesCorrections) {
  for (const float omega : {0.5f, 1.0f, 1.5f}) {
    SolverScene scene;
    scene.add({0, 0, 0}, 0);
    scene.add({1.5, 0, 0}, 1);
    scene.add<Distance>().add({1, 0}, {1});
    SolverSettings settings;
    settings.relaxation = omega;
    scene.use(settings);
    scene.solve();
    EXPECT_NEAR(scene.body.at(1).x, 1.5 - 0.5 * static_cast<double>(omega), 1e-6);
  }
}

// A forward sweep propagates a disturbance in the order of the links only; a symmetric sweep in both
// directions.
TEST(GaussSeidel, SymmetricSweepGoesBothWays) {
  const auto moved_at_the_top = [](Sweep sweep) {
    SolverScene scene;
    for (int i = 0; i < 5; ++i) scene.add({0.1 * i, 0, 0}, 1);
    // One projector per link fixes the order.
    for (std::uint32_t i = 0; i < 4; ++i) scene.add<Distance>().add({i, i + 1}, {0.1f});
    scene.body.position[4].x += 0.05f;
    SolverSettings settings = test::kind_of(SolverKind::gauss_seidel);
    settings.sweep = sweep;
    scene.use(settings);
    scene.solve();
    return std::fabs(scene.body.offset[0].x);
  };
  EXPECT_LT(moved_at_the_top(Sweep::forward), 1e-6f);
  EXPECT_GT(moved_at_the_top(Sweep::symmetric), 1e-3f);
}

// Chebyshev is off if a constraint without a linear form acts (here a floor made of custom constraints).
TEST(GaussSeidel, ChebyshevIsOffBesideContacts) {
  const auto solve = [](float chebyshev) {
    SolverScene scene = test::sheet(10, 0.1, 0.01, 0, true);
    for (Vec4f& x : scene.body.position) x.z *= 1.1f, x.y -= 0.01f;
    auto floor = std::make_unique<CustomProjector>();
    for (std::uint32_t i = 10; i < 100; ++i) {
      auto above = std::make_shared<CallbackConstraint>(
          std::vector<std::uint32_t>{i}, [](std::span<const Vec3f> x, std::span<Vec3f> gradient) {
            gradient[0] = {0, 1, 0};
            return x[0].y;
          });
      above->sense = Sense::non_negative;
      floor->add(std::move(above));
    }
    scene.projectors.push_back(std::move(floor));
    scene.substep.iterations = 20;
    SolverSettings settings;
    settings.chebyshev = chebyshev;
    scene.use(settings);
    scene.solve();
    for (std::size_t i = 10; i < 100; ++i) EXPECT_GE(scene.body.at(i).y, -1e-7);
    return scene.body.offset;
  };
  const std::vector<Vec4f> plain = solve(0), accelerated = solve(0.95f);
  EXPECT_EQ(std::memcmp(plain.data(), accelerated.data(), plain.size() * sizeof(Vec4f)), 0);
}

// A user's own stretch constraints state their rest length or their links (constraints/constraint.h). The default
// solver then treats them as it treats Distance.

/// The law of Distance.
struct Spring {
  static constexpr const char* name = "spring";
  static constexpr int arity = 2;
  static constexpr Sense sense = Sense::equality;
  static constexpr bool unit_gradients = true;
  template <class T>
  struct Params {
    T length;  ///< m
  };
  template <class T>
  static T evaluate(const Vec3<T> (&x)[2], const Params<T>& p, Vec3<T> (&gradient)[2]) {
    return Distance::evaluate<T>(x, {p.length}, gradient);
  }
  static float rest_length(const Params<float>& p) { return p.length; }
};

/// Green's strain of a link, C = (|x0 - x1|^2 / l^2 - 1) / 2  [1].
struct GreenLink {
  static constexpr const char* name = "green_link";
  static constexpr int arity = 2;
  static constexpr Sense sense = Sense::equality;
  template <class T>
  struct Params {
    T length;  ///< m
  };
  template <class T>
  static T evaluate(const Vec3<T> (&x)[2], const Params<T>& p, Vec3<T> (&gradient)[2]) {
    const T inverse = T(1) / (p.length * p.length);
    const Vec3<T> d = x[0] - x[1];
    gradient[0] = d * inverse;
    gradient[1] = -gradient[0];
    return (dot(d, d) * inverse - T(1)) * T(0.5f);
  }
  static std::array<KindLink, 1> links(const Params<float>& p, const std::array<float, 1>& alpha) {
    return {KindLink{0, 1, p.length, 1 / alpha[0]}};
  }
};

/// Rigid, square, 1 m wide, 0.2 kg, pinned by its first row, after it has swung for half a second.
template <class Kind>
SolverScene hung_cloth(SolverKind solver) {
  constexpr std::uint32_t n = 40;
  const double l = 1.0 / (n - 1);
  SolverScene scene;
  for (std::uint32_t i = 0; i < n * n; ++i)
    scene.add({l * (i % n), -l * (i / n), 0}, i < n ? 0 : 0.2 / (n * n));
  auto& links = scene.add<Kind>();
  test::for_each_link(n, [&](std::uint32_t a, std::uint32_t b) {
    links.add({a, b}, {static_cast<float>(length(scene.body.at(a) - scene.body.at(b)))});
  });
  scene.gravity = {0, -9.81f, 0};
  scene.substep = {.h = 1.0f / 600, .count = 10};
  scene.use(test::kind_of(solver));
  for (int k = 0; k < 300; ++k) scene.step();
  return scene;
}

/// A rope of 50 links and 2 m, level at first, held by one end. The other end carries a hundred times the mass of the
/// rest.
template <class Kind>
SolverScene swung_rope() {
  SolverScene scene;
  for (int i = 0; i <= 50; ++i) scene.add({0.04 * i, 0, 0}, i == 0 ? 0 : i == 50 ? 5 : 0.001);
  auto& links = scene.add<Kind>();
  for (std::uint32_t i = 0; i < 50; ++i) links.add({i, i + 1}, {0.04f}, {1e-7f});
  scene.gravity = {0, -9.81f, 0};
  scene.substep = {.h = 1.0f / 600, .count = 10};
  scene.use(test::kind_of(SolverKind::automatic));
  for (int k = 0; k < 300; ++k) scene.step();
  return scene;
}

/// By how much the cloth is longer than at rest. [m]
double sag(const SolverScene& scene) {
  double lowest = 0;
  for (std::size_t i = 0; i < scene.velocity.size(); ++i) lowest = std::min(lowest, scene.body.at(i).y);
  return -lowest - 1;
}

bool same_bits(const std::vector<Vec4f>& a, const std::vector<Vec4f>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec4f)) == 0;
}

TEST(OwnKinds, SpringsOfAClothAreSolvedAsDistances) {
  const SolverScene own = hung_cloth<Spring>(SolverKind::automatic),
                    distances = hung_cloth<Distance>(SolverKind::automatic);
  EXPECT_TRUE(same_bits(own.body.position, distances.body.position));
  EXPECT_LT(sag(own), 0.2 * sag(hung_cloth<Spring>(SolverKind::gauss_seidel)));
}

TEST(OwnKinds, SpringsOfARopeAreSolvedAsDistances) {
  const SolverScene own = swung_rope<Spring>();
  EXPECT_TRUE(same_bits(own.body.position, swung_rope<Distance>().body.position));
  double longest = 0;
  for (std::size_t i = 0; i < 50; ++i)
    longest = std::max(longest, length(own.body.at(i) - own.body.at(i + 1)) / 0.04);
  EXPECT_LT(longest, 1.001);
}

TEST(OwnKinds, LinksOfAnotherLawGetLevels) {
  const double own = sag(hung_cloth<GreenLink>(SolverKind::automatic));
  EXPECT_LT(own, 0.2 * sag(hung_cloth<GreenLink>(SolverKind::gauss_seidel)));
  EXPECT_NEAR(own, sag(hung_cloth<Distance>(SolverKind::automatic)), 0.002);
}

}  // namespace souple::test_solver_gauss_seidel
