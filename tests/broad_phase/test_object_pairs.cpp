#include "souple/broad_phase/object_pairs.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_broad_phase_object_pairs {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs brute_force(const std::vector<Bounds>& boxes) {
  Pairs pairs;
  for (std::uint32_t a = 0; a < boxes.size(); ++a)
    for (std::uint32_t b = a + 1; b < boxes.size(); ++b)
      if (overlap(boxes[a], boxes[b])) pairs.emplace_back(a, b);
  return pairs;
}

Pairs swept(const std::vector<Bounds>& boxes) {
  BoxSweep sweep;
  const auto found = sweep.find(boxes);
  Pairs pairs(found.begin(), found.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Bounds> random_boxes(int count, const Vec3d& room, test::Random& random) {
  std::vector<Bounds> boxes;
  for (int k = 0; k < count; ++k) {
    const Vec3d at = random.point(-1, 1), half = random.point(0, 0.1);
    const Vec3d center{at.x * room.x, at.y * room.y, at.z * room.z};
    boxes.push_back({Vec3f(center - half), Vec3f(center + half)});
  }
  return boxes;
}

TEST(BoxSweep, FindsAllPairsOfBoxesThatOverlap) {
  test::Random random(1);
  for (const Vec3d& room : {Vec3d{1, 1, 1}, Vec3d{0.1, 3, 0.1}, Vec3d{2, 0, 2}, Vec3d{0, 0, 0}}) {
    const std::vector<Bounds> boxes = random_boxes(200, room, random);
    EXPECT_FALSE(brute_force(boxes).empty());
    EXPECT_EQ(swept(boxes), brute_force(boxes));
  }
}

TEST(BoxSweep, BoxesThatAreEmptyInfiniteOrNoNumbers) {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  test::Random random(2);
  std::vector<Bounds> boxes = random_boxes(50, {1, 1, 1}, random);
  boxes[7] = {{inf, inf, inf}, {-inf, -inf, -inf}};
  boxes[19] = {{-inf, -inf, -inf}, {inf, inf, inf}};
  boxes[23].lo.x = nan, boxes[31].hi = {nan, nan, nan}, boxes[40].lo = {nan, nan, nan};
  EXPECT_EQ(swept(boxes), brute_force(boxes));
  EXPECT_TRUE(swept({}).empty());
}

TEST(ObjectPairs, HoldsWhatWasAddedInEitherOrder) {
  test::Random random(3);
  ObjectPairs pairs;
  EXPECT_FALSE(pairs.contains(0, 0));
  for (int round = 0; round < 2; ++round) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
    for (int k = 0; k < 500; ++k) {
      const Vec3d p = random.point(0, 60);
      const auto a = static_cast<std::uint32_t>(p.x), b = static_cast<std::uint32_t>(p.y);
      pairs.add(a, b);
      expected.insert(std::minmax(a, b));
    }
    for (std::uint32_t a = 0; a < 60; ++a)
      for (std::uint32_t b = 0; b < 60; ++b)
        EXPECT_EQ(pairs.contains(a, b), expected.count(std::minmax(a, b)) > 0) << a << ", " << b;
    pairs.clear();
    EXPECT_TRUE(pairs.empty());
    EXPECT_FALSE(pairs.contains(1, 2));
  }
}

}  // namespace souple::test_broad_phase_object_pairs
