// Pairs of balls at vertices are those that a loop over all finds, with every instruction set.
#include "souple/contacts/ball_cells.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "tests/collision/random.h"
#include "tests/instruction_sets.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_contacts_vertex_ball_kernels {

using test::Random;

/// Balls at random in a box of 1 m, at random elsewhere at rest.
struct Balls {
  std::vector<Vec3f> place, rest;
  std::vector<float> radius, margin;

  Balls(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    const auto between = [&](double lo, double hi) { return static_cast<float>(random.uniform(lo, hi)); };
    for (std::size_t m = 0; m < count; ++m) {
      place.push_back({between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5)});
      rest.push_back({between(-1, 1), between(-1, 1), between(-1, 1)});
      radius.push_back(between(0.02, 0.05));
      margin.push_back(between(0, 0.02));
    }
  }
  SearchedBalls searched() const { return {place, rest, radius, margin}; }
};

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

Pairs pairs_of(const Balls& balls, const kernels::VertexBallKernels& kernels, float rest_part) {
  BallCells cells;
  cells.sort(balls.searched(), 2 * 0.07f);
  cells.gather(balls.searched(), 0, balls.place.size());
  BallCells::Search search;
  Pairs pairs;
  for (std::size_t slot = 0; slot < cells.size(); ++slot)
    for (const std::uint32_t other : cells.find_near(slot, rest_part, kernels, search))
      pairs.push_back(
          {std::min(cells.ball(slot), cells.ball(other)), std::max(cells.ball(slot), cells.ball(other))});
  return pairs;
}

TEST(VertexBallKernels, FindThePairsThatALoopOverAllFinds) {
  constexpr float rest_part = 0.1f;
  const Balls balls(700, 3);
  Pairs expected;
  for (std::uint32_t i = 0; i < balls.place.size(); ++i)
    for (std::uint32_t j = i + 1; j < balls.place.size(); ++j) {
      const float sum = balls.radius[i] + balls.radius[j];
      if (length(balls.place[i] - balls.place[j]) < sum + balls.margin[i] + balls.margin[j] &&
          rest_part * length(balls.rest[i] - balls.rest[j]) >= sum)
        expected.push_back({i, j});
    }
  ASSERT_GT(expected.size(), 200u);
  for (const InstructionSet set : all_sets()) {
    Pairs pairs = pairs_of(balls, kernels::find_vertex_ball_kernels(set), rest_part);
    std::sort(pairs.begin(), pairs.end());
    EXPECT_EQ(pairs, expected) << simd_name(set);
  }
}

}  // namespace souple::test_contacts_vertex_ball_kernels
