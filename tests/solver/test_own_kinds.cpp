#include "tests/solver/solver_scene.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <gtest/gtest.h>

// A user's own stretch constraints state their rest length or their links (constraints/constraint.h). The default
// solver then treats them as it treats Distance.

namespace souple::test_solver_own_kinds {

using test::SolverScene;

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
  const auto link = [&](std::uint32_t a, std::uint32_t b) {
    links.add({a, b}, {static_cast<float>(length(scene.body.at(a) - scene.body.at(b)))});
  };
  for (std::uint32_t row = 0; row < n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t i = row * n + column;
      if (column + 1 < n) link(i, i + 1);
      if (row + 1 < n) link(i, i + n);
      if (row + 1 < n && column + 1 < n) link(i, i + n + 1), link(i + 1, i + n);
    }
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

}  // namespace souple::test_solver_own_kinds
