#include "souple/geometry/builders.h"
#include "souple/geometry/measures.h"
#include "souple/host/grab.h"
#include "souple/world/debug_draw.h"
#include "souple/world/world.h"

#include <benchmark/benchmark.h>

// Cost per frame of preparing a 200 x 200 cloth for drawing: its positions in user order and its normals.
// Together with the upload to the graphics card it must stay far below 3 ms.

namespace souple {
namespace {

/// A cloth that hangs from two corners, some frames after its release. A zero impulse makes its mirror as
/// stale as a step does.
struct HangingCloth {
  World world{{.substeps = 2}};
  ObjectId cloth;

  explicit HangingCloth(int columns) : cloth(world.add_cloth(grid(columns, columns, 2.0))) {
    world.pin(cloth, vertices({0, static_cast<std::uint32_t>(columns - 1)}));
    for (int i = 0; i < 3; ++i) world.step(1.0 / 60);
  }
  void make_stale() { world.apply_impulse(cloth, vertices({5000}), {}); }
};

void mirror(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    hanging.make_stale();
    benchmark::DoNotOptimize(hanging.world.positions(hanging.cloth).data());
    benchmark::DoNotOptimize(hanging.world.normals(hanging.cloth).data());
  }
}
BENCHMARK(mirror)->Arg(200)->Unit(benchmark::kMillisecond);

void normals(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  const auto x = hanging.world.positions(hanging.cloth);
  const auto triangles = hanging.world.triangles(hanging.cloth);
  std::vector<Vec3f> result(x.size());
  for (auto _ : state) {
    vertex_normals<float>(x, triangles, result);
    benchmark::DoNotOptimize(result.data());
  }
}
BENCHMARK(normals)->Arg(200)->Unit(benchmark::kMillisecond);

/// A grab starts with a click and must be ready before the next frame.
void grab_and_release(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  const Vec3f point = hanging.world.positions(hanging.cloth)[20100];
  for (auto _ : state) Grab(hanging.world, hanging.cloth, 20100, point);
}
BENCHMARK(grab_and_release)->Arg(200)->Unit(benchmark::kMillisecond);

/// All constraints as a renderer draws them.
void debug_draw_constraints(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  std::size_t points = 0;
  DebugDraw draw;
  draw.constraint = [&](const DebugConstraint& constraint) { points += constraint.points.size(); };
  for (auto _ : state) hanging.world.debug_draw(draw);
  benchmark::DoNotOptimize(points);
}
BENCHMARK(debug_draw_constraints)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace souple
