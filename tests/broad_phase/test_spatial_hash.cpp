#include "souple/broad_phase/spatial_hash.h"
#include "tests/collision/random.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace souple::test_broad_phase_spatial_hash {

std::vector<Bounds> random_boxes(std::size_t count, double cube, double largest, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<Bounds> boxes;
  for (std::size_t b = 0; b < count; ++b) {
    const Vec3f lo(random.point(-cube, cube));
    const double size = largest * std::pow(random.uniform(0, 1), 6);
    boxes.push_back({lo, lo + Vec3f(random.point(0, size))});
  }
  return boxes;
}

std::vector<std::uint32_t> overlapping(const std::vector<Bounds>& boxes, const Bounds& box) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < boxes.size(); ++b)
    if (overlap(boxes[b], box)) result.push_back(b);
  return result;
}

// Queries from points to the whole cube find the boxes that a test of all boxes finds.
TEST(SpatialHash, FindsWhatOverlapsABoxOfAnySize) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Bounds> boxes = random_boxes(3000, 1, 0.5, 1);
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  test::Random random(2);
  std::size_t sum = 0;
  for (int query = 0; query < 300; ++query) {
    const Vec3f lo(random.point(-1, 1));
    const Bounds box{lo, lo + Vec3f(random.point(0, std::pow(0.5, query % 12)))};
    std::vector<std::uint32_t> found;
    hash.find(box, found);
    ASSERT_EQ(found, overlapping(boxes, box));
    sum += found.size();
  }
  EXPECT_GT(sum, 1000u);
  std::vector<std::uint32_t> all;
  hash.find({{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}}, all);
  EXPECT_EQ(all.size(), boxes.size());
}

TEST(SpatialHash, EachPairHasOneWhoFindsIt) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Bounds> boxes = random_boxes(2000, 1, 0.6, 3);
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found, expected;
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    std::vector<std::uint32_t> partners;
    hash.find_partners(a, partners);
    for (const std::uint32_t b : partners) found.push_back(std::minmax(a, b));
    for (const std::uint32_t b : overlapping(boxes, boxes[a]))
      if (b > a) expected.push_back({a, b});
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

// Covers both searches, in boxes of all sizes: also the first box, the last one, all of them and none.
TEST(SpatialHash, LeavesOutARangeOfBoxes) {
  const auto threads = make_threads(Threading::pool, 2);
  const std::vector<Bounds> boxes = random_boxes(2000, 1, 0.6, 4);
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  test::Random random(5);
  for (std::uint32_t a = 0; a < 400; ++a) {
    const auto ends = std::minmax({static_cast<std::uint32_t>(random.uniform(0, 2000)),
                                   static_cast<std::uint32_t>(random.uniform(0, 2000))});
    std::uint32_t first = ends.first, last = ends.second;
    if (a % 4 == 1) first = 0;
    if (a % 4 == 2) last = 2000;
    const auto without = [&](std::vector<std::uint32_t> found) {
      found.erase(
          std::remove_if(found.begin(), found.end(), [&](std::uint32_t b) { return first <= b && b < last; }),
          found.end());
      return found;
    };
    const double side = std::pow(0.5, a % 12);
    const Vec3f lo(random.point(-1, 1));
    const Bounds box{lo, lo + Vec3f(random.point(0, side))};
    std::vector<std::uint32_t> found, all, partners;
    hash.find(box, {first, last}, found);
    ASSERT_EQ(found, without(overlapping(boxes, box)));
    hash.find_partners(a, all);
    hash.find_partners(a, {first, last}, partners);
    ASSERT_EQ(partners, without(all));
  }
}

// One huge box costs entries in few cells, and does not add entries of other boxes.
TEST(SpatialHash, AHugeBoxCostsNothing) {
  const auto threads = make_threads(Threading::serial, 1);
  std::vector<Bounds> boxes;
  test::Random random(6);
  for (int b = 0; b < 10000; ++b) {
    const Vec3f lo(random.point(-1, 1));
    boxes.push_back({lo, lo + Vec3f{0.02f, 0.02f, 0.02f}});
  }
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  const std::size_t before = hash.entries();
  EXPECT_LE(before, 8 * boxes.size());
  boxes.push_back({{-20, -20, -20}, {20, 20, 20}});
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *threads);
  EXPECT_LE(hash.entries(), before + 8);
}

}  // namespace souple::test_broad_phase_spatial_hash
