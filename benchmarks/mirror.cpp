#include "souple/geometry/builders.h"
#include "souple/geometry/measures.h"
#include "souple/host/grab.h"
#include "souple/world/world.h"

#include <benchmark/benchmark.h>

// What showing a 200 x 200 cloth costs a frame before anything is drawn: its positions in user order and its
// normals. With the upload to the graphics card they have to stay far below 3 ms.

namespace souple {
namespace {

/// Hangs from two corners, some frames after it was let go. Its step's cost does not matter: teleport makes
/// the mirror stale as well.
struct HangingCloth {
  World world{{.substeps = 2}};
  ObjectId cloth;

  explicit HangingCloth(int columns) : cloth(world.add_cloth(grid(columns, columns, 2.0))) {
    world.pin(cloth, vertices({0, static_cast<std::uint32_t>(columns - 1)}));
    for (int i = 0; i < 3; ++i) world.step(1.0 / 60);
  }
  void make_stale() { world.apply_impulse(cloth, vertices({5000}), {}); }
};

void Mirror(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    hanging.make_stale();
    benchmark::DoNotOptimize(hanging.world.positions(hanging.cloth).data());
    benchmark::DoNotOptimize(hanging.world.normals(hanging.cloth).data());
  }
}
BENCHMARK(Mirror)->Arg(200)->Unit(benchmark::kMillisecond);

void Normals(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  const auto x = hanging.world.positions(hanging.cloth);
  const auto triangles = hanging.world.triangles(hanging.cloth);
  std::vector<Vec3f> normals(x.size());
  for (auto _ : state) {
    vertex_normals<float>(x, triangles, normals);
    benchmark::DoNotOptimize(normals.data());
  }
}
BENCHMARK(Normals)->Arg(200)->Unit(benchmark::kMillisecond);

/// A grab starts with a click: it has to be there before the next frame.
void GrabAndRelease(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  const Vec3f point = hanging.world.positions(hanging.cloth)[20100];
  for (auto _ : state) Grab(hanging.world, hanging.cloth, 20100, point);
}
BENCHMARK(GrabAndRelease)->Arg(200)->Unit(benchmark::kMillisecond);

/// All constraints as a renderer asks for them.
void DebugDrawConstraints(benchmark::State& state) {
  HangingCloth hanging(static_cast<int>(state.range(0)));
  std::size_t points = 0;
  DebugDraw draw;
  draw.constraint = [&](const DebugConstraint& constraint) { points += constraint.points.size(); };
  for (auto _ : state) hanging.world.debug_draw(draw);
  benchmark::DoNotOptimize(points);
}
BENCHMARK(DebugDrawConstraints)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace souple
