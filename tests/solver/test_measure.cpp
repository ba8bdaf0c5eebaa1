#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_solver_measure {

// Residuals as in reports, compared with sums over single constraints in double, on any number of threads.
TEST(Measure, IsTheSumOverConstraintsOnAnyNumberOfThreads) {
  constexpr std::uint32_t links = 5003;  // whole chunks and a remainder
  std::vector<Vec4f> position(links + 1);
  for (std::uint32_t i = 0; i <= links; ++i)
    position[i] = {0.01f * static_cast<float>(i) + 0.004f * std::sin(0.7f * static_cast<float>(i)), 0, 0, 1};
  SetProjector<Distance> chain;
  Residual expected;
  for (std::uint32_t i = 0; i < links; ++i) {
    const float rest = i == 77 ? 0 : 0.008f + 0.001f * static_cast<float>(i % 5);
    chain.add({i, i + 1}, {rest}, {2e-4f});
    const double C = std::fabs(static_cast<double>(position[i + 1].x) - static_cast<double>(position[i].x)) -
                     static_cast<double>(rest);
    expected.largest = std::max(expected.largest, std::fabs(C));
    expected.sum += std::fabs(C);
    expected.energy += 0.5 * C * C / 2e-4;
    if (rest > 0) expected.largest_strain = std::max(expected.largest_strain, C / static_cast<double>(rest));
  }
  chain.prepare(position.size());
  std::vector<Vec4f> unmoved(position.size());
  const ParticleView view{position, unmoved, unmoved};
  const Residual alone = chain.residual(view);
  EXPECT_EQ(alone.count, links);
  EXPECT_NEAR(alone.largest, expected.largest, 1e-5 * expected.largest);
  EXPECT_NEAR(alone.sum, expected.sum, 1e-4 * expected.sum);
  EXPECT_NEAR(alone.energy, expected.energy, 1e-4 * expected.energy);
  EXPECT_NEAR(alone.largest_strain, expected.largest_strain, 1e-4 * expected.largest_strain);
  for (const int count : {1, 2, 3, 8}) {
    const auto threads = make_threads(Threading::automatic, count);
    const Residual together = chain.residual(view, threads.get());
    EXPECT_EQ(together.count, alone.count);
    EXPECT_EQ(together.largest, alone.largest);
    EXPECT_EQ(together.sum, alone.sum);
    EXPECT_EQ(together.largest_strain, alone.largest_strain);
  }
}

}  // namespace souple::test_solver_measure
