#include "render/context.h"
#include "render/display.h"
#include "render/passes/surfaces.h"
#include "souple/geometry/builders.h"

#include <benchmark/benchmark.h>

// Cost per frame, in addition to rasterization, of a moving 200 x 200 cloth: positions and normals in user
// order, the draw list, the upload. Bound: 3 ms of CPU time.

namespace souple::render {
namespace {

void shown_cloth(benchmark::State& state) {
  const OffscreenContext context;
  const int columns = static_cast<int>(state.range(0));
  World world({.substeps = 2});
  const ObjectId cloth = world.add_cloth(grid(columns, columns, 2.0));
  world.pin(cloth, vertices({0, static_cast<std::uint32_t>(columns - 1)}));
  world.step(1.0 / 60);

  SubjectDrawing drawing;
  SurfacesPass surfaces;
  for (auto _ : state) {
    world.apply_impulse(cloth, vertices({5000}), {});  // makes the mirror as stale as a step does
    const DrawList& list = drawing.update(subject_of(world), {});
    surfaces.update(list.surfaces);
  }
}
BENCHMARK(shown_cloth)->Arg(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace souple::render
