#include "souple/constraints/tether.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/error.h"
#include "souple/studies/make_solver.h"
#include "tests/expect_error.h"
#include "tests/solver/solver_scene.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

namespace souple::test_solver_linear_solvers {

using test::SolverScene;

std::string name_of(const testing::TestParamInfo<SolverKind>& info) {
  return std::string(make_solver(test::kind_of(info.param))->name());
}

/// Iterations after which the solver has converged on a scene of a few dozen constraints.
int enough(SolverKind kind) {
  switch (kind) {
    case SolverKind::gauss_seidel:
      return 2000;
    case SolverKind::jacobi:
      return 6000;
    default:
      return 12;
  }
}

class EverySolver : public testing::TestWithParam<SolverKind> {};
INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver,
                         testing::Values(SolverKind::gauss_seidel, SolverKind::jacobi, SolverKind::direct,
                                         SolverKind::conjugate_gradient, SolverKind::dense),
                         name_of);

class GlobalSolver : public testing::TestWithParam<SolverKind> {};
INSTANTIATE_TEST_SUITE_P(Solvers, GlobalSolver,
                         testing::Values(SolverKind::direct, SolverKind::conjugate_gradient,
                                         SolverKind::dense),
                         name_of);

// Five particles of 0.1 kg hang from a pin on springs of 1000 N/m: each spring extends by the weight below it
// over k.
TEST_P(EverySolver, ChainExtendsByItsWeight) {
  SolverScene scene;
  for (int i = 0; i < 6; ++i) scene.add({0, -0.1 * i, 0}, i == 0 ? 0 : 0.1);
  auto& links = scene.add<Distance>();
  for (std::uint32_t i = 0; i < 5; ++i) links.add({i, i + 1}, {0.1f}, {1e-3f});
  scene.gravity = {0, -9.81f, 0};
  scene.damping = 0.9f;
  scene.substep.iterations = GetParam() == SolverKind::jacobi ? 40 : 8;
  scene.use(test::kind_of(GetParam()));
  for (int k = 0; k < 600; ++k) scene.step();
  for (std::size_t i = 0; i < 5; ++i) {
    const double extension = length(scene.body.at(i) - scene.body.at(i + 1)) - 0.1;
    const double expected = 1e-3 * 0.1 * 9.81 * static_cast<double>(5 - i);
    EXPECT_NEAR(extension, expected, 2e-3 * expected) << "link " << i;
  }
}

// A hanging elastic sheet comes to rest in one shape with all solvers; dense is the reference.
TEST_P(EverySolver, SheetHangsAsTheOracleSays) {
  const auto hang = [](SolverKind kind) {
    SolverScene scene = test::sheet(5, 0.1, 0.01, 1e-3f, true);
    scene.gravity = {0, 0, 9.81f};
    scene.damping = 0.9f;
    scene.substep.iterations = kind == SolverKind::jacobi ? 800 : kind == SolverKind::gauss_seidel ? 100 : 2;
    scene.use(test::kind_of(kind));
    for (int k = 0; k < 200; ++k) scene.step();
    return scene.body.all();
  };
  const std::vector<Vec3d> oracle = hang(SolverKind::dense), mine = hang(GetParam());
  const double sag = oracle.back().z - 0.4;
  EXPECT_GT(sag, 5e-4);
  for (std::size_t i = 0; i < mine.size(); ++i) EXPECT_LT(length(mine[i] - oracle[i]), 2e-3 * sag) << i;
}

// Three particles of different mass with three slightly violated rigid distances: each solver converges to
// the nearest triangle, as the seed's classical method does.
TEST_P(EverySolver, AgreesWithTheOracleOnATriangle) {
  const auto solve = [](SolverKind kind) {
    SolverScene scene;
    scene.add({0, 0, 0}, 1);
    scene.add({1.001, 0, 0}, 2);
    scene.add({0.3, 0.999, 0.1}, 0.5);
    auto& links = scene.add<Distance>();
    links.add({0, 1}, {1});
    links.add({1, 2}, {1.2f});
    links.add({2, 0}, {1.05f});
    scene.substep.iterations = enough(kind);
    scene.use(test::kind_of(kind));
    scene.solve();
    return scene.body.all();
  };
  const std::vector<Vec3d> oracle = solve(SolverKind::dense), mine = solve(GetParam());
  const Vec3d rest[] = {{0, 0, 0}, {1.001, 0, 0}, {0.3, 0.999, 0.1}};
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, length(oracle[i] - rest[i]));
  EXPECT_GT(longest, 5e-3);
  EXPECT_NEAR(length(oracle[0] - oracle[1]), 1, 1e-6);
  EXPECT_NEAR(length(oracle[1] - oracle[2]), 1.2, 1e-6);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(length(mine[i] - oracle[i]), 0.02 * longest) << i;
}

// A free, crumpled sheet of rigid and elastic constraints: the corrections of a solver have neither momentum
// nor angular momentum. Exception: Gauss-Seidel corrects each constraint about its current positions, so the
// angular momentum about the initial positions is not zero.
TEST_P(EverySolver, KeepsMomentum) {
  SolverScene scene = test::sheet(6, 0.1, 0.02, 0, false);
  for (std::size_t i = 0; i < scene.body.position.size(); ++i) {
    Vec4f& x = scene.body.position[i];
    x.set_xyz(x.xyz() + Vec3f(test::scatter3(i) * 0.02));
    x.w *= static_cast<float>(1.5 + test::scatter(1000 + i));
  }
  auto& soft = scene.add<Distance>();
  for (std::uint32_t i = 0; i + 7 < 36; ++i) soft.add({i, i + 7}, {0.12f}, {1e-4f}, 0.001f);
  auto& membrane = scene.add<TriangleMembrane>();
  const Vec3d corners[] = {{0, 0, 0}, {0.1, 0, 0}, {0, 0, 0.1}};
  for (std::uint32_t i = 0; i < 5; ++i)
    membrane.add({i, i + 1, i + 6}, TriangleMembrane::from_rest(corners, {1, 0, 0}),
                 TriangleMembrane::compliance(1000, 800, 0.3, 400, 0.005));
  const std::vector<Vec3d> before = scene.body.all();
  scene.use(test::kind_of(GetParam()));
  scene.solve();
  const test::Momentum momentum = test::momentum_of(scene.body, before);
  EXPECT_GT(momentum.linear_scale, 1e-4);
  EXPECT_LT(length(momentum.linear), 3e-7 * momentum.linear_scale);
  if (GetParam() == SolverKind::gauss_seidel) return;
  EXPECT_LT(length(momentum.angular), 3e-6 * momentum.angular_scale);
}

// A tether acts only while its particles are too far apart.
TEST_P(EverySolver, TetherOnlyPullsIn) {
  SolverScene scene;
  scene.add({0, 0, 0}, 0);
  scene.add({1.5, 0, 0}, 1);
  scene.add({0.5, 0.25, 0}, 1);
  auto& tethers = scene.add<Tether>();
  tethers.add({1, 0}, {1});
  tethers.add({2, 0}, {1});
  scene.substep.iterations = GetParam() == SolverKind::jacobi ? 50 : 3;
  scene.use(test::kind_of(GetParam()));
  scene.solve();
  EXPECT_NEAR(scene.body.at(1).x, 1, 2e-5);
  EXPECT_EQ(length(scene.body.at(2) - Vec3d{0.5, 0.25, 0}), 0);
}

// A rod of 1.2 m pulls a particle to a distance of 0.8 m from the pin, well inside its tether of 1 m. At
// first both constraints are violated; the tether must not oppose the rod.
TEST_P(EverySolver, TetherNeverPullsOut) {
  SolverScene scene;
  scene.add({0, 0, 0}, 0);
  scene.add({2, 0, 0}, 0);
  scene.add({1.05, 0, 0}, 1);
  scene.add<Tether>().add({2, 0}, {1});
  scene.add<Distance>().add({2, 1}, {1.2f});
  scene.substep.iterations = GetParam() == SolverKind::jacobi ? 200 : 3;
  scene.use(test::kind_of(GetParam()));
  scene.solve();
  EXPECT_NEAR(scene.body.at(2).x, 0.8, 2e-5);
}

// Classical PBD: n iterations with stiffness k remove the fraction k of the violation, whatever n.
TEST_P(EverySolver, StiffnessOfPbdDoesNotDependOnIterations) {
  for (const int iterations : {1, 4}) {
    SolverScene scene;
    scene.add({0, 0, 0}, 0);
    scene.add({1.5, 0, 0}, 1);
    scene.add<Distance>().add({1, 0}, {1}, {}, 0, 0.6f);
    scene.substep.mode = Mode::pbd;
    scene.substep.iterations = iterations;
    scene.use(test::kind_of(GetParam()));
    scene.solve();
    EXPECT_NEAR(scene.body.at(1).x, 1 + 0.4 * 0.5, 2e-5) << iterations;
  }
}

// One linearization restores the length of a rigid sheet that is stretched by a tenth; one sweep cannot.
TEST_P(GlobalSolver, OneIterationMendsAStretchedSheet) {
  SolverScene scene = test::sheet(8, 0.1, 0.01, 0, true);
  for (Vec4f& x : scene.body.position) x.z *= 1.1f;
  scene.use(test::kind_of(GetParam()));
  scene.solve();
  const Residual left = scene.projectors[0]->residual(scene.body.view());
  EXPECT_LT(left.largest_strain, 0.005);
}

// A rigid sheet swings down from horizontal. It is pinned by a row, or by two corners and then folds.
double largest_strain_of_hanging(SolverKind kind, std::size_t n, int frames, bool by_corners) {
  SolverScene scene = test::sheet(n, 2.0 / static_cast<double>(n), 1.0 / static_cast<double>(n * n), 0, true);
  if (by_corners)
    for (std::size_t i = 1; i + 1 < n; ++i) scene.body.position[i].w = static_cast<float>(n * n);
  scene.gravity = {0, -9.81f, 0};
  scene.substep.h = 1.0f / 600;
  scene.use(test::kind_of(kind));
  double largest = 0, lowest = 0;
  for (int frame = 0; frame < frames; ++frame) {
    for (int k = 0; k < 10; ++k) scene.step();
    lowest = std::min(lowest, scene.body.at(n * n - 1).y);
    const Residual residual = scene.projectors[0]->residual(scene.body.view());
    for (const Vec3f& v : scene.velocity)
      if (!is_finite(v) || length(v) > 30) return 1e30;
    largest = std::max(largest, residual.largest_strain);
  }
  // A quarter of free fall, or half of the sheet's length.
  EXPECT_LT(lowest, -std::min(9.81 / 8 * std::pow(frames / 60.0, 2), 1.0)) << "the sheet did not fall";
  return largest;
}

TEST(LinearSolvers, RigidSheetHangs) {
  EXPECT_LT(largest_strain_of_hanging(SolverKind::direct, 16, 30, false), 0.002);
  EXPECT_LT(largest_strain_of_hanging(SolverKind::conjugate_gradient, 16, 30, false), 0.002);
  EXPECT_LT(largest_strain_of_hanging(SolverKind::dense, 6, 20, false), 0.002);
}

TEST(LinearSolvers, RigidSheetHangsByTwoCorners) {
  EXPECT_LT(largest_strain_of_hanging(SolverKind::direct, 16, 30, true), 0.02);
  EXPECT_LT(largest_strain_of_hanging(SolverKind::conjugate_gradient, 16, 30, true), 0.02);
  EXPECT_LT(largest_strain_of_hanging(SolverKind::dense, 6, 20, true), 0.02);
}

TEST(LinearSolvers, RigidClothHangsDirectSlow) {
  EXPECT_LT(largest_strain_of_hanging(SolverKind::direct, 50, 60, false), 0.002);
}
TEST(LinearSolvers, RigidClothHangsConjugateGradientSlow) {
  EXPECT_LT(largest_strain_of_hanging(SolverKind::conjugate_gradient, 50, 60, false), 0.01);
}
TEST(LinearSolvers, RigidClothHangsDenseSlow) {
  EXPECT_LT(largest_strain_of_hanging(SolverKind::dense, 8, 60, false), 0.002);
}

// Rigid constraints that outnumber the unknowns: the diagnostic reports the floor that replaces infinite
// stiffness. The floor has the promised stiffness, tested by a rigid link that carries the whole weight.
TEST(LinearSolvers, FloorIsReportedAndStiff) {
  SolverScene scene;
  scene.add({0, 0, 0}, 0);
  scene.add({0, -0.1, 0}, 1);
  auto& links = scene.add<Distance>();
  for (int twin = 0; twin < 4; ++twin) links.add({0, 1}, {0.1f});
  scene.gravity = {0, -9.81f, 0};
  scene.damping = 0.5f;
  scene.use(test::kind_of(SolverKind::direct));
  for (int k = 0; k < 50; ++k) scene.step();
  EXPECT_NE(scene.solver->diagnostic().find("springs approximate 4 rigid rows"), std::string::npos)
      << scene.solver->diagnostic();
  EXPECT_NEAR(length(scene.body.at(1)), 0.1, 1e-5 * 0.1 + 2e-8);
}

// A chain of rigid links is solved without a floor, even with redundant links.
TEST(LinearSolvers, ChainNeedsNoFloor) {
  SolverScene scene;
  for (int i = 0; i < 10; ++i) scene.add({0.1 * i, 0, 0}, i == 0 ? 0 : 0.1);
  auto& links = scene.add<Distance>();
  for (std::uint32_t i = 0; i < 9; ++i) links.add({i, i + 1}, {0.1f});
  links.add({0, 1}, {0.1f});
  scene.gravity = {0, -9.81f, 0};
  scene.use(test::kind_of(SolverKind::direct));
  for (int k = 0; k < 100; ++k) scene.step();
  EXPECT_EQ(scene.solver->diagnostic(), "");
  EXPECT_LT(scene.projectors[0]->residual(scene.body.view()).largest_strain, 0.01);
}

TEST(LinearSolvers, DenseRefusesWhatIsTooLarge) {
  SolverScene scene = test::sheet(14, 0.1, 0.01, 0, true);
  expect_error([&] { scene.use(test::kind_of(SolverKind::dense)); }, {"conjugate_gradient"});
}

// A block of 24 x 24 x 24 particles with links to their neighbors: its factor has too much fill-in.
TEST(LinearSolvers, DirectRefusesWhatIsTooLarge) {
  constexpr std::uint32_t n = 24;
  SolverScene scene;
  auto& links = scene.add<Distance>();
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t i = (z * n + y) * n + x;
        scene.add({0.1 * x, 0.1 * y, 0.1 * z}, 0.01);
        if (x > 0) links.add({i, i - 1}, {0.1f}, {1e-5f});
        if (y > 0) links.add({i, i - n}, {0.1f}, {1e-5f});
        if (z > 0) links.add({i, i - n * n}, {0.1f}, {1e-5f});
        if (x > 0 && y > 0 && z > 0) links.add({i, i - 1 - n - n * n}, {0.17f}, {1e-5f});
      }
  expect_error([&] { scene.use(test::kind_of(SolverKind::direct)); }, {"conjugate_gradient"});
}

// Partial sums have chunks of fixed size.
TEST(LinearSolvers, ResultsDoNotDependOnThreads) {
  const auto solve = [](SolverKind kind, int threads) {
    SolverScene scene = test::sheet(40, 0.05, 0.001, 0, true);
    for (std::size_t i = 0; i < scene.body.position.size(); ++i)
      scene.body.position[i].set_xyz(scene.body.position[i].xyz() + Vec3f(test::scatter3(i) * 0.005));
    scene.threads = make_threads(Threading::automatic, threads);
    scene.substep.iterations = 2;
    scene.use(test::kind_of(kind));
    scene.solve();
    return scene.body.offset;
  };
  for (const SolverKind kind : {SolverKind::conjugate_gradient, SolverKind::jacobi, SolverKind::direct}) {
    const std::vector<Vec4f> one = solve(kind, 1);
    for (const int threads : {2, 3, 8}) {
      const std::vector<Vec4f> many = solve(kind, threads);
      EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(Vec4f)), 0) << threads;
    }
  }
}

// Particles are pinned and released without another `prepare`.
TEST_P(EverySolver, FollowsPins) {
  SolverScene scene;
  for (int i = 0; i < 3; ++i) scene.add({1.5 * i, 0, 0}, 1);
  auto& links = scene.add<Distance>();
  links.add({0, 1}, {1});
  links.add({1, 2}, {1});
  scene.use(test::kind_of(GetParam()));
  scene.body.position[0].w = 0;
  scene.substep.iterations = enough(GetParam());
  scene.solve();
  EXPECT_EQ(length(scene.body.at(0)), 0);
  EXPECT_NEAR(scene.body.at(1).x, 1, 1e-4);
  EXPECT_NEAR(scene.body.at(2).x, 2, 1e-4);
  scene.body.position[0].w = 1;
  scene.body.offset[2].x += 0.3f;
  scene.solve();
  EXPECT_NEAR(scene.body.at(0).x, 0.1, 1e-4);
}

// A scene without constraints is not an error.
TEST_P(EverySolver, TakesAnEmptyScene) {
  SolverScene scene;
  scene.add({0, 0, 0}, 1);
  scene.add<Distance>();
  scene.use(test::kind_of(GetParam()));
  scene.solve();
  EXPECT_EQ(length(scene.body.at(0)), 0);
}

// Constraints between pinned particles, and between coincident particles without a direction, have no effect.
TEST_P(EverySolver, LeavesAloneWhatItCannotMove) {
  SolverScene scene;
  scene.add({0, 0, 0}, 0);
  scene.add({1.5, 0, 0}, 0);
  scene.add({3, 0, 0}, 1);
  scene.add({3, 0, 0}, 1);
  auto& links = scene.add<Distance>();
  links.add({0, 1}, {1});
  links.add({2, 3}, {1});
  scene.use(test::kind_of(GetParam()));
  scene.solve();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(length(Vec3d(scene.body.offset[i].xyz())), 0);
}

}  // namespace souple::test_solver_linear_solvers
