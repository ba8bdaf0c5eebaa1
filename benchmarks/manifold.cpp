#include "souple/rigid/manifold.h"

#include <array>
#include <numbers>

#include <benchmark/benchmark.h>

// Cost of the contact points of one pair of shapes. Second argument: 1: with the cache of the last call, 0: without.

namespace souple {
namespace {

constexpr double pi = std::numbers::pi;

struct Case {
  const char* name;
  ConvexShape a, b;
  BodyPose pose_a, pose_b{};
  double margin = 0.01;
};

const std::array<Case, 8>& cases() {
  static const ConvexShape box = convex_box({0.5, 0.5, 0.5}), floor = convex_box({5, 0.5, 5});
  static const Quatd tilt = Quatd::from_axis_angle(normalized(Vec3d{1, 0, 2}), 1e-4);
  static const Quatd about_y = Quatd::from_axis_angle({0, 1, 0}, 0.3);
  static const Quatd about_x = Quatd::from_axis_angle({1, 0, 0}, pi / 4);
  static const Quatd about_z = Quatd::from_axis_angle({0, 0, 1}, pi / 4);
  static const ConvexShape cylinder = convex_cylinder(0.5, 0.5, 24);
  static const std::array<Case, 8> all{{
      {"box on an equal box", box, box, {{0, 0.9995, 0}, tilt}},
      {"box on a turned box: an octagon", box, box, {{0.1, 0.9995, 0}, tilt * about_y}},
      {"box on a floor", box, floor, {{0.1, 0.9995, 0}, tilt * about_y}},
      {"edge on edge", box, box, {{0.1, 1.4, 0.2}, about_x}, {{}, about_z}},
      {"boxes apart", box, box, {{1.3, 0.4, 0.1}, about_x * about_z}},
      {"corner near corner", box, box, {{1.003, 1.004, 1.005}, {}}, {}, 0.1},
      {"cylinder on a cylinder", cylinder, cylinder, {{0.1, 0.9995, 0}, tilt}},
      {"sphere on a box", convex_sphere(0.5), box, {{0.1, 0.9995, 0}, {}}},
  }};
  return all;
}

void manifold_of_pair(benchmark::State& state) {
  const Case& c = cases()[static_cast<std::size_t>(state.range(0))];
  AxisCache cache;
  for (auto _ : state) {
    if (state.range(1) == 0) cache = {};
    benchmark::DoNotOptimize(find_manifold(c.a, c.pose_a, c.b, c.pose_b, c.margin, cache));
  }
  state.SetLabel(c.name);
}
BENCHMARK(manifold_of_pair)->ArgsProduct({benchmark::CreateDenseRange(0, 7, 1), {0, 1}});

}  // namespace
}  // namespace souple
