#include "souple/studies/segment_triangle/choice.h"

#include "souple/error.h"
#include "souple/simd/pack.h"
#include "souple/studies/segment_triangle/all.h"

namespace souple {
namespace {

// Which every processor of the architecture has.
#if defined(__SSE2__)
using Plainest = simd::Pack<simd::Sse>;
#elif defined(__aarch64__)
using Plainest = simd::Pack<simd::Neon>;
#else
using Plainest = simd::Pack<simd::Scalar>;
#endif

/// Calls f with the test of that name.
template <class Function>
auto with_test(SegmentTest test, const Function& f) {
  switch (test) {
    case SegmentTest::plane_projection:
      return f(PlaneProjection{});
    case SegmentTest::signed_volumes:
      return f(SignedVolumes{});
    case SegmentTest::inclusion:
      return f(Inclusion{});
    case SegmentTest::moeller_trumbore:
      return f(MoellerTrumbore{});
    case SegmentTest::watertight:
      return f(Watertight{});
  }
  throw Error("segment-triangle test: unknown value; expected one of SegmentTest");
}

template <class T>
T load(const float* p) {
  if constexpr (std::is_same_v<T, float>)
    return *p;
  else
    return T::load(p);
}
void store(float a, float* p) {
  *p = a;
}
void store(const Plainest& a, float* p) {
  a.store(p);
}

/// Tests triangles from `begin` on, `lanes` at a time, as long as there are so many. Returns the first that is left.
template <class Test, class T>
std::size_t cross(const Segment<float>& segment, const TriangleColumns& triangles, const CrossingColumns& out,
                  std::size_t begin, std::size_t lanes) {
  const auto corner = [&](int k, std::size_t i) {
    const auto& columns = triangles.corner[k];
    return Vec3<T>{load<T>(columns[0] + i), load<T>(columns[1] + i), load<T>(columns[2] + i)};
  };
  Test::template prepare<T>(segment, [&](const auto& crosses) {
    for (; begin + lanes <= triangles.count; begin += lanes) {
      const Crossing<T> found = crosses(Corners<T>{corner(0, begin), corner(1, begin), corner(2, begin)});
      store(found.t, out.t + begin), store(found.side, out.side + begin);
      for (int k = 0; k < 3; ++k) store(found.weight[k], out.weight[k] + begin);
    }
  });
  return begin;
}

}  // namespace

const CrossingTest& crossing_test_of(SegmentTest test) {
  return *with_test(test, []<class Test>(Test) { return &crossing_test<Test>; });
}

void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings, bool packed) {
  with_test(test, [&]<class Test>(Test) {
    const std::size_t done =
        packed ? cross<Test, Plainest>(segment, triangles, crossings, 0, std::size_t{Plainest::lanes}) : 0;
    cross<Test, float>(segment, triangles, crossings, done, 1);
  });
}

}  // namespace souple
