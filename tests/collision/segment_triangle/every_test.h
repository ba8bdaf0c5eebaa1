#pragma once

#include "souple/studies/segment_triangle/all.h"
#include "souple/studies/segment_triangle/choice.h"

#include <string>

#include <gtest/gtest.h>

namespace souple::test {

using EveryTest = testing::Types<PlaneProjection, SignedVolumes, Inclusion, MoellerTrumbore, Watertight>;

template <class Test>
SegmentTest choice_of() {
  if constexpr (std::is_same_v<Test, PlaneProjection>) return SegmentTest::plane_projection;
  if constexpr (std::is_same_v<Test, SignedVolumes>) return SegmentTest::signed_volumes;
  if constexpr (std::is_same_v<Test, Inclusion>) return SegmentTest::inclusion;
  if constexpr (std::is_same_v<Test, MoellerTrumbore>) return SegmentTest::moeller_trumbore;
  if constexpr (std::is_same_v<Test, Watertight>) return SegmentTest::watertight;
}

struct NameOfTest {
  template <class Test>
  static std::string GetName(int) {
    for (const auto& [name, test] : segment_test_names)
      if (test == choice_of<Test>()) return name;
    return "?";
  }
};

template <class T>
bool crosses(const Crossing<T>& crossing) {
  return crossing.side != 0;
}

}  // namespace souple::test
