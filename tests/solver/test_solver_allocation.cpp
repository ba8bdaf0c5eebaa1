#include "tests/count_allocations.h"
#include "tests/solver/solver_scene.h"

#include <gtest/gtest.h>

namespace souple::test_solver_allocation {

void expect_no_allocation(test::SolverScene& scene) {
  scene.step();
  const std::vector<Projector*> order = scene.order();
  const ParticleView view = scene.body.view();
  const long before = test::allocations();
  for (int k = 0; k < 3; ++k) {
    for (Projector* projector : order) projector->begin_substep(view, scene.substep);
    scene.solver->solve(order, view, scene.substep, *scene.threads);
  }
  EXPECT_EQ(test::allocations() - before, 0) << scene.solver->name();
}

// All solvers that promise allocation-free steps (docs/solvers.md); solvers that use Eigen do not.
TEST(SolverAllocation, AWarmSubstepAllocatesNothing) {
  for (SolverSettings settings :
       {test::kind_of(SolverKind::gauss_seidel), SolverSettings{.colors = 3},
        test::kind_of(SolverKind::jacobi), test::kind_of(SolverKind::conjugate_gradient),
        test::kind_of(SolverKind::hierarchical)}) {
    test::SolverScene scene = test::sheet(20, 0.1, 0.01, 1e-6f, true);
    scene.gravity = {0, -9.81f, 0};
    scene.substep.iterations = 4;
    settings.chebyshev = 0.9f;
    settings.sweep = Sweep::symmetric;
    scene.use(settings);
    expect_no_allocation(scene);
  }
}

TEST(SolverAllocation, AWarmSubstepOfARopeAllocatesNothing) {
  test::SolverScene scene;
  auto& distances = scene.add<Distance>();
  for (std::uint32_t i = 0; i < 30; ++i) {
    scene.add({0.1 * i, 0, 0}, i == 0 ? 0 : 0.01);
    if (i > 0) distances.add({i - 1, i}, {0.1f}, {1e-6f});
  }
  scene.gravity = {0, -9.81f, 0};
  scene.use({});
  expect_no_allocation(scene);
}

}  // namespace souple::test_solver_allocation
