#include "souple/collision/segment_triangle/choice.h"

#include "souple/collision/kernels/segments.h"
#include "souple/collision/segment_triangle/all.h"
#include "souple/error.h"
#include "souple/simd/find_for.h"
#include "souple/simd/instruction_set.h"

namespace souple {
namespace {

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

const kernels::SegmentKernels* find_segment_kernels(InstructionSet set) {
  return detail::find_for(set, []<class Isa>(std::type_identity<Isa>) -> const kernels::SegmentKernels* {
    if constexpr (std::is_same_v<Isa, simd::Scalar>) {
      return nullptr;
    } else {
      return &kernels::segment_kernels<Isa>();
    }
  });
}

Vec3f corner_of(const TriangleColumns& triangles, int k, std::size_t i) {
  return {triangles.corner[k][0][i], triangles.corner[k][1][i], triangles.corner[k][2][i]};
}

/// Tests the triangles from `begin` on, one by one.
template <class Test>
void cross_rest(const Segment<float>& segment, const TriangleColumns& triangles, const CrossingColumns& out,
                std::size_t begin) {
  Test::template prepare<float>(segment, [&](const auto& crosses) {
    for (std::size_t i = begin; i < triangles.count; ++i) {
      const Crossing<float> found = crosses(
          Corners<float>{corner_of(triangles, 0, i), corner_of(triangles, 1, i), corner_of(triangles, 2, i)});
      out.t[i] = found.t;
      for (int k = 0; k < 3; ++k) out.weight[k][i] = found.weight[k];
      out.side[i] = found.side;
    }
  });
}

}  // namespace

Crossing<float> find_crossing(SegmentTest test, const Segment<float>& segment,
                              const Corners<float>& corners) {
  return with_test(test, [&]<class Test>(Test) { return find_crossing<Test>(segment, corners); });
}

Crossing<double> find_crossing(SegmentTest test, const Segment<double>& segment,
                               const Corners<double>& corners) {
  return with_test(test, [&]<class Test>(Test) { return find_crossing<Test>(segment, corners); });
}

void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings) {
  find_crossings(test, segment, triangles, crossings, instruction_set());
}

void find_crossings(SegmentTest test, const Segment<float>& segment, const TriangleColumns& triangles,
                    const CrossingColumns& crossings, InstructionSet set) {
  with_test(test, [&]<class Test>(Test) {
    const kernels::SegmentKernels* compiled = find_segment_kernels(set);
    const std::size_t done =
        compiled ? compiled->find<Test>()(segment, triangles, crossings) : std::size_t{0};
    cross_rest<Test>(segment, triangles, crossings, done);
  });
}

}  // namespace souple
