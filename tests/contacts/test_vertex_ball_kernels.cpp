// Kernels of balls at vertices: all instruction sets return the bits of the scalar code, and pairs are those that a loop
// over all finds.
#include "souple/contacts/ball_cells.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/math/vec4.h"
#include "tests/collision/random.h"
#include "tests/instruction_sets.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

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

/// All that a substep writes.
struct Result {
  std::vector<std::uint32_t> found;
  std::vector<float> columns;
  std::vector<Vec4f> moving;
};

// Disjoint pairs: ball k and ball k + count / 2.
Result substep(const Balls& balls, bool displacement, InstructionSet set) {
  const auto& kernels = kernels::find_vertex_ball_kernels(set);
  const std::size_t pairs = balls.place.size() / 2;
  std::vector<Vec4f> position, start, place;
  Result result;
  for (std::size_t m = 0; m < balls.place.size(); ++m) {
    const Vec3f& x = balls.place[m % pairs];  // the second ball of a pair is near the first
    const Vec3f at = x + balls.rest[m] * 0.03f, motion = balls.rest[(m + 1) % balls.rest.size()] * 0.02f;
    const float w = m % 7 == 0 ? 0.0f : 1 + balls.radius[m];
    const Vec3f from = displacement ? Vec3f{} : at, to = from + motion;
    position.push_back({at.x, at.y, at.z, w});
    start.push_back({from.x, from.y, from.z, 0});
    result.moving.push_back({to.x, to.y, to.z, displacement ? 0 : w});
    const Vec3f end = at + motion;
    place.push_back({end.x, end.y, end.z, w});
  }
  std::vector<std::uint32_t> first_float[2];
  std::vector<float> distance;
  for (std::uint32_t p = 0; p < pairs; ++p) {
    first_float[0].push_back(4 * p), first_float[1].push_back(4 * (p + static_cast<std::uint32_t>(pairs)));
    distance.push_back(balls.radius[p] + balls.radius[p + pairs]);
  }
  const kernels::BallPairColumns columns{{first_float[0].data(), first_float[1].data()}, distance.data()};
  result.found.resize(pairs);
  result.found.resize(kernels.find_near(&place.data()->x, columns, 0.1f, 0, pairs, result.found.data()));
  const std::size_t n = result.found.size();
  std::vector<std::uint32_t> ends[2];
  for (auto& end : ends) end.resize(n);
  result.columns.resize(14 * n);
  std::size_t next = 0;
  const auto column = [&] { return &result.columns[n * next++]; };
  kernels::BallContactColumns contacts;
  for (std::size_t k = 0; k < 2; ++k) contacts.first_float[k] = ends[k].data(), contacts.share[k] = column();
  for (float*& axis : contacts.normal) axis = column();
  contacts.gap = column();
  for (float*& axis : contacts.start) axis = column();
  contacts.kinetic_friction = column(), contacts.normal_sum = column();
  for (float*& axis : contacts.tangent_sum) axis = column();
  kernels::BallRecords records;
  records.moving = records.corrected = &result.moving.data()->x;
  records.position = displacement ? &position.data()->x : records.moving;
  records.start = &start.data()->x;
  kernels.describe(records, columns, {0.5f, 0.3f, 0.005f, 0.01f}, result.found.data(), contacts, 0, n);
  for (int sweep = 0; sweep < 2; ++sweep) kernels.project(records, contacts, 0.5f, 0, n);
  return result;
}

TEST(VertexBallKernels, InstructionSetsChangeNoBit) {
  for (const std::size_t count : {30u, 1000u})
    for (const bool displacement : {false, true}) {
      const Balls balls(count, 11);
      const Result scalar = substep(balls, displacement, InstructionSet::scalar);
      EXPECT_GT(scalar.found.size(), count / 10);
      for (const InstructionSet set : all_sets()) {
        const Result result = substep(balls, displacement, set);
        EXPECT_EQ(result.found, scalar.found) << simd_name(set);
        EXPECT_EQ(result.columns, scalar.columns) << simd_name(set);
        for (std::size_t m = 0; m < count; ++m)
          EXPECT_EQ(result.moving[m].xyz(), scalar.moving[m].xyz()) << simd_name(set);
      }
    }
}

}  // namespace
}  // namespace souple
