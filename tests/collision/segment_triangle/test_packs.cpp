#include "tests/collision/segment_triangle/cases.h"
#include "tests/collision/segment_triangle/every_test.h"

#include <bit>
#include <cstdint>
#include <vector>

// Packs give the bits of the scalar code.

namespace souple::test::test_segment_triangle_packs {

constexpr std::size_t count = 1003;  // not a multiple of any register width

/// Corners of one triangle of each kind in turn, in columns.
struct Triangles {
  std::vector<Corners<float>> corners;
  std::vector<float> numbers[3][3];
  std::vector<Segment<float>> segments;

  explicit Triangles(std::uint64_t seed) {
    Cases cases(seed);
    for (std::size_t i = 0; i < count; ++i) {
      const Case<float> one = cases.make<float>(static_cast<int>(i) % Cases::kinds);
      corners.push_back(one.corners), segments.push_back(one.segment);
      for (int j = 0; j < 3; ++j) {
        numbers[0][j].push_back(one.corners.a[j]);
        numbers[1][j].push_back(one.corners.b[j]);
        numbers[2][j].push_back(one.corners.c[j]);
      }
    }
  }
  TriangleColumns columns() const {
    TriangleColumns columns;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) columns.corner[k][j] = numbers[k][j].data();
    columns.count = count;
    return columns;
  }
};

struct Found {
  std::vector<float> t, weight[3], side;
  Found() : t(count), weight{t, t, t}, side(t) {}
  CrossingColumns columns() {
    return {t.data(), {weight[0].data(), weight[1].data(), weight[2].data()}, side.data()};
  }
};

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

template <class Test>
void expect_same_bits(const Segment<float>& segment, const Triangles& triangles, Found& found, int& hits) {
  for (std::size_t i = 0; i < count; ++i) {
    const Crossing<float> one = find_crossing<Test>(segment, triangles.corners[i]);
    ASSERT_TRUE(same_bits(found.t[i], one.t) && same_bits(found.side[i], one.side) &&
                same_bits(found.weight[0][i], one.weight.x) && same_bits(found.weight[1][i], one.weight.y) &&
                same_bits(found.weight[2][i], one.weight.z))
        << "triangle " << i << ": t " << found.t[i] << ", " << one.t;
    hits += crosses(one);
  }
}

template <class Test>
class SegmentTrianglePacks : public testing::Test {};
TYPED_TEST_SUITE(SegmentTrianglePacks, EveryTest, NameOfTest);

TYPED_TEST(SegmentTrianglePacks, GiveTheBitsOfTheScalarCode) {
  const Triangles triangles(11);
  Found found;
  for (const bool packed : {false, true}) {
    int hits = 0;
    for (std::size_t s = 0; s < triangles.segments.size(); s += 7) {
      find_crossings(choice_of<TypeParam>(), triangles.segments[s], triangles.columns(), found.columns(),
                     packed);
      expect_same_bits<TypeParam>(triangles.segments[s], triangles, found, hits);
      if (testing::Test::HasFatalFailure()) return;
    }
    EXPECT_GT(hits, 1000) << packed;
  }
}

/// Where the products of one lane cancel, packs compute the error terms of all lanes: all lanes keep their
/// own bits.
TYPED_TEST(SegmentTrianglePacks, GiveTheSameBitsOnEdges) {
  Triangles triangles(12);
  Found found;
  int hits = 0;
  for (std::size_t i = 0; i < count; i += 3) {
    const Vec3f target =
        i % 2 == 0 ? triangles.corners[i].a : (triangles.corners[i].a + triangles.corners[i].b) * 0.5f;
    const Segment<float> segment{{}, target, 2};
    find_crossings(choice_of<TypeParam>(), segment, triangles.columns(), found.columns());
    expect_same_bits<TypeParam>(segment, triangles, found, hits);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace souple::test::test_segment_triangle_packs
