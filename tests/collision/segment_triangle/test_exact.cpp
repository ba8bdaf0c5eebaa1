#include "tests/collision/segment_triangle/cases.h"
#include "tests/collision/segment_triangle/every_test.h"
#include "tests/collision/segment_triangle/truth.h"

#include <array>
#include <iomanip>
#include <sstream>

// Every test against exact arithmetic.

namespace souple::test::test_segment_triangle_exact {

/// Number of roundings that an answer must tolerate.
constexpr double roundings = 16;

template <class Test>
constexpr Lengths lengths_of{
    .corners_alone = std::is_same_v<Test, SignedVolumes>,
    .by_plane = std::is_same_v<Test, PlaneProjection> || std::is_same_v<Test, Inclusion>};

template <class T>
std::string text(const Vec3<T>& v) {
  std::ostringstream out;
  out << std::setprecision(17) << "(" << v.x << ", " << v.y << ", " << v.z << ")";
  return out.str();
}

/// The error in an answer; empty if it is right.
template <class T>
std::string complaint(const Crossing<T>& found, const Truth& truth, const Segment<T>& segment) {
  if (crosses(found) != (truth.answer == Answer::crosses))
    return truth.answer == Answer::crosses ? "not found" : "there is none";
  if (!crosses(found))
    return found.t > std::numeric_limits<T>::max() && found.weight == Vec3<T>{} ? "" : "numbers for a miss";
  if (static_cast<double>(found.side) != truth.side) return "the wrong side";
  if (!(found.t >= 0 && found.t <= segment.max_t)) return "beyond the ends";
  if (!(std::fabs(static_cast<double>(found.t) - truth.t) <= truth.t_error)) return "the parameter";
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(static_cast<double>(found.weight[k]) - truth.weight[k]) <= truth.weight_error))
      return "a weight";
  return "";
}

struct Tally {
  std::size_t crossing = 0, missing = 0, ambiguous = 0, doubtful = 0;
  std::array<std::size_t, Cases::kinds> clear{};
};

template <class Test, class T>
void check_case(const Case<T>& one, int kind, bool always_exact, Tally& tally) {
  const Slack slack = slack_of(one.segment, one.corners, lengths_of<Test>, roundings);
  const Truth truth = truth_of(one.segment, one.corners, slack, always_exact);
  tally.doubtful += truth.was_doubtful;
  if (always_exact) {
    const Truth quick = truth_of(one.segment, one.corners, slack);
    ASSERT_EQ(truth.answer, quick.answer) << "the filter is wrong, kind " << kind;
  }
  if (truth.answer == Answer::ambiguous) {
    ++tally.ambiguous;
    return;
  }
  ++(truth.answer == Answer::crosses ? tally.crossing : tally.missing);
  ++tally.clear[static_cast<std::size_t>(kind)];
  const Crossing<T> found = find_crossing<Test>(one.segment, one.corners);
  const std::string wrong = complaint(found, truth, one.segment);
  ASSERT_EQ(wrong, "") << "kind " << kind << ", o " << text(one.segment.origin) << " d "
                       << text(one.segment.direction) << " a " << text(one.corners.a) << " b "
                       << text(one.corners.b) << " c " << text(one.corners.c) << "\nt " << found.t << " of "
                       << truth.t << " within " << truth.t_error << "\nweights " << text(found.weight)
                       << " of " << text(truth.weight) << " within " << truth.weight_error;
}

template <class Test, class T>
Tally check_cases(int count, std::uint64_t seed) {
  Cases cases(seed);
  Tally tally;
  for (int i = 0; i < count && !testing::Test::HasFatalFailure(); ++i)
    check_case<Test>(cases.make<T>(i % Cases::kinds), i % Cases::kinds, i % 199 == 0, tally);
  return tally;
}

/// Most cases that are not constructed to be ambiguous are clear, and every kind has clear cases.
template <class Test, class T>
void expect_agreement(int count, std::uint64_t seed) {
  const Tally tally = check_cases<Test, T>(count, seed);
  if (testing::Test::HasFatalFailure()) return;
  const auto part = [&](std::size_t n) { return static_cast<double>(n) / count; };
  EXPECT_GT(part(tally.crossing), 0.15);
  EXPECT_GT(part(tally.missing), 0.15);
  EXPECT_LT(part(tally.ambiguous), 0.5);
  for (std::size_t kind = 0; kind < tally.clear.size(); ++kind)
    EXPECT_GT(part(tally.clear[kind]), kind == 2 || kind == 3 ? -1 : 0.01) << "kind " << kind;
  testing::Test::RecordProperty("crossing", static_cast<int>(tally.crossing));
  testing::Test::RecordProperty("missing", static_cast<int>(tally.missing));
  testing::Test::RecordProperty("ambiguous", static_cast<int>(tally.ambiguous));
  testing::Test::RecordProperty("doubtful", static_cast<int>(tally.doubtful));
}

template <class Test>
class SegmentTriangle : public testing::Test {};
TYPED_TEST_SUITE(SegmentTriangle, EveryTest, NameOfTest);

TYPED_TEST(SegmentTriangle, AgreesWithExactArithmeticInFloat) {
  expect_agreement<TypeParam, float>(200'000, 1);
}

TYPED_TEST(SegmentTriangle, AgreesWithExactArithmeticInDouble) {
  expect_agreement<TypeParam, double>(200'000, 2);
}

TYPED_TEST(SegmentTriangle, ExactInFloatSlow) {
  expect_agreement<TypeParam, float>(10'000'000, 3);
}

TYPED_TEST(SegmentTriangle, ExactInDoubleSlow) {
  expect_agreement<TypeParam, double>(10'000'000, 4);
}

/// Tests that decide by products and sums of small whole numbers only. The watertight test does where it
/// divides by a power of two.
template <class Test>
class SegmentTriangleOnWholeNumbers : public testing::Test {};
using ExactTest = testing::Types<SignedVolumes, MoellerTrumbore, Watertight>;
TYPED_TEST_SUITE(SegmentTriangleOnWholeNumbers, ExactTest, NameOfTest);

int sign(double a) {
  return a < 0 ? -1 : (a > 0 ? 1 : 0);
}

/// Corners on a grid: edges, corners and ends are hit exactly, and are part of the triangle and the segment.
TYPED_TEST(SegmentTriangleOnWholeNumbers, EdgesCornersAndEndsBelongToIt) {
  Random random(5);
  const auto whole = [&] { return static_cast<float>(std::floor(random.uniform(-4, 5))); };
  const auto point = [&] {
    const float x = whole(), y = whole(), z = whole();
    return Vec3f{x, y, z};
  };
  int on_rim = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Vec3f a = point(), b = point(), c = point(), o = point();
    const Vec3f d =
        !std::is_same_v<TypeParam, Watertight> ? point() : Vec3f{whole(), whole(), i % 2 == 0 ? 8.0f : -8.0f};
    const Volumes<double> v{Vec3d(o), Vec3d(d), Vec3d(a), Vec3d(b), Vec3d(c)};  // exact
    const int side = sign(v.sum);
    const bool within = side != 0 && sign(v.edge.x) * side >= 0 && sign(v.edge.y) * side >= 0 &&
                        sign(v.edge.z) * side >= 0 && sign(v.height) * side >= 0 &&
                        abs(v.height) <= abs(v.sum);
    const Crossing<float> found = find_crossing<TypeParam>(Segment<float>{o, d}, Corners<float>{a, b, c});
    ASSERT_EQ(crosses(found), within) << text(o) << text(d) << text(a) << text(b) << text(c);
    on_rim += within && sign(v.edge.x) * sign(v.edge.y) * sign(v.edge.z) == 0;
  }
  EXPECT_GT(on_rim, 1000);
}

TYPED_TEST(SegmentTriangle, NothingCrossesWhatHasNoSizeOrIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  const Corners<float> good{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
  const Segment<float> through{{0, 0, 1}, {0, 0, -2}};
  const auto hit = [](const Segment<float>& segment, const Corners<float>& corners) {
    return crosses(find_crossing<TypeParam>(segment, corners));
  };
  ASSERT_TRUE(hit(through, good));
  EXPECT_FALSE(hit({{0, 0, 1}, {0, 0, 0}}, good));
  EXPECT_FALSE(hit({{0, 0, 0}, {0, 0, 0}}, good));
  EXPECT_FALSE(hit({{-3, 0, 0}, {6, 0, 0}}, good)) << "in the plane";
  EXPECT_FALSE(hit(through, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
  EXPECT_FALSE(hit(through, {{-1, 0, 0}, {1, 0, 0}, {0, 0, 0}}));
  for (const float bad : {nan, infinite, -infinite}) {
    EXPECT_FALSE(hit({{0, 0, 1}, {0, bad, -2}}, good)) << bad;
    EXPECT_FALSE(hit({{bad, 0, 1}, {0, 0, -2}}, good)) << bad;
    EXPECT_FALSE(hit(through, {{-1, -1, bad}, {1, -1, 0}, {0, 2, 0}})) << bad;
  }
  EXPECT_FALSE(hit({{0, 0, 1}, {0, 0, -2}, nan}, good));
}

TYPED_TEST(SegmentTriangle, TellsWhereAndFromWhichSide) {
  const Corners<double> corners{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};  // counter-clockwise from +z
  const auto from_front = find_crossing<TypeParam>(segment_between(Vec3d{1, 2, 3}, Vec3d{1, 2, -1}), corners);
  EXPECT_DOUBLE_EQ(from_front.t, 0.75);
  EXPECT_EQ(from_front.side, 1);
  EXPECT_DOUBLE_EQ(from_front.weight.x, 0.25);
  EXPECT_DOUBLE_EQ(from_front.weight.y, 0.25);
  EXPECT_DOUBLE_EQ(from_front.weight.z, 0.5);
  const auto from_behind =
      find_crossing<TypeParam>(segment_between(Vec3d{1, 2, -1}, Vec3d{1, 2, 3}), corners);
  EXPECT_DOUBLE_EQ(from_behind.t, 0.25);
  EXPECT_EQ(from_behind.side, -1);
  EXPECT_FALSE(crosses(find_crossing<TypeParam>(segment_between(Vec3d{1, 2, 3}, Vec3d{1, 2, 1}), corners)));
}

}  // namespace souple::test::test_segment_triangle_exact
