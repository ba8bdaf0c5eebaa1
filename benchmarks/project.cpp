#include "app/bench_scenes.h"
#include "souple/constraints/dihedral_bending.h"
#include "souple/constraints/distance.h"
#include "souple/constraints/isometric_bending.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/reorder.h"
#include "souple/solver/set_projector.h"
#include "souple/solver/solver.h"

#include <benchmark/benchmark.h>

// Projection alone, by kind, through SetProjector: all colors of a mesh, once per iteration; and the
// stages of a step. SOUPLE_SIMD selects the instruction set.

namespace souple {
namespace {

constexpr int side = 200;  // vertices along a side of the cloths

/// Particles at a mesh's rest positions, stretched by 1 %, numbered as in a world.
struct Particles {
  std::vector<Vec4f> position, moving, start;
  std::vector<Vec3d> rest;
  std::vector<std::uint32_t> number;  ///< particle of each vertex

  explicit Particles(const std::vector<Vec3d>& vertices) : number(vertices.size()) {
    const std::vector<std::uint32_t> order = morton_order(vertices);
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      number[order[i]] = i;
      rest.push_back(vertices[order[i]]);
      const Vec3f x(rest.back() * 1.01);
      position.push_back({x.x, x.y, x.z, 1});
    }
    moving = start = std::vector<Vec4f>(position.size());
  }
  ParticleView view() { return {.position = position, .moving = moving, .start = start}; }
};

template <std::size_t n>
std::array<std::uint32_t, n> renumbered(std::array<std::uint32_t, n> indices, const Particles& particles) {
  for (std::uint32_t& i : indices) i = particles.number[i];
  return indices;
}

template <std::size_t n, class Function>
auto at_rest(const std::array<std::uint32_t, n>& indices, const Particles& particles, const Function& f) {
  Vec3d x[n];
  for (std::size_t k = 0; k < n; ++k) x[k] = particles.rest[indices[k]];
  return f(x);
}

void fill(SetProjector<Distance>& set, const TriangleMesh& mesh, const Particles& particles) {
  for (const Edge& edge : unique_edges(mesh.triangles)) {
    const Edge e = renumbered(edge, particles);
    set.add(e, {static_cast<float>(length(particles.rest[e[0]] - particles.rest[e[1]]))}, {1e-8f});
  }
}

template <class Kind>
void fill(SetProjector<Kind>& set, const TriangleMesh& mesh, const Particles& particles) {
  for (const Hinge& hinge : interior_edges(mesh.triangles)) {
    const Hinge h = renumbered(hinge, particles);
    at_rest(h, particles,
            [&](const Vec3d(&x)[4]) { set.add(h, Kind::from_rest(x), Kind::compliance(1e-5)); });
  }
}

void fill(SetProjector<TriangleMembrane>& set, const TriangleMesh& mesh, const Particles& particles) {
  for (const Triangle& triangle : mesh.triangles) {
    const Triangle t = renumbered(triangle, particles);
    at_rest(t, particles, [&](const Vec3d(&x)[3]) {
      const double area = 0.5 * length(cross(x[1] - x[0], x[2] - x[0]));
      set.add(t, TriangleMembrane::from_rest(x, {1, 0, 0}),
              TriangleMembrane::compliance(4000, 4000, 0.3, 1500, area));
    });
  }
}

void fill(SetProjector<NeoHookean>& set, const TetMesh& mesh, const Particles& particles) {
  for (const Tet& tet : mesh.tets) {
    const Tet t = renumbered(tet, particles);
    at_rest(t, particles, [&](const Vec3d(&x)[4]) {
      const double volume = dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) / 6;
      set.add(t, NeoHookean::from_rest(x), NeoHookean::compliance(1e6, 0.4, volume));
    });
  }
}

/// Projects for the duration of the benchmark, always from the same positions.
template <class Kind, class Mesh>
void project_all(benchmark::State& state, const Mesh& mesh) {
  Particles particles(mesh.positions);
  SetProjector<Kind> set;
  fill(set, mesh, particles);
  set.prepare(particles.rest.size());
  const std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  const Substep substep{.h = 1.0f / 600};
  const ParticleView view = particles.view();
  set.begin_substep(view, substep);
  for (auto _ : state) {
    sweep(set, view, substep, *threads);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(set.size()));
}

template <class Kind>
void project_cloth(benchmark::State& state) {
  project_all<Kind>(state, grid(side, side, 2));
}
void project_neo_hookean(benchmark::State& state) {
  project_all<NeoHookean>(state, tet_bar(60, 12, 12, {1.2, 0.24, 0.24}));
}
BENCHMARK(project_cloth<Distance>)->Unit(benchmark::kMicrosecond);
BENCHMARK(project_cloth<DihedralBending>)->Unit(benchmark::kMicrosecond);
BENCHMARK(project_cloth<IsometricBending>)->Unit(benchmark::kMicrosecond);
BENCHMARK(project_cloth<TriangleMembrane>)->Unit(benchmark::kMicrosecond);
BENCHMARK(project_neo_hookean)->Unit(benchmark::kMicrosecond);

/// One stage of the steps of the cloth of `souple bench`, timed by the world's own clock.
void stage(benchmark::State& state) {
  Settings settings;
  settings.threads = 1;
  settings.measure_residuals = false;
  World world(settings);
  app::find_bench_scene("cloth").build(world, side);
  const auto which = static_cast<std::size_t>(state.range(0));
  world.step(1.0 / 60);
  for (auto _ : state) state.SetIterationTime(1e-3 * world.step(1.0 / 60).milliseconds[which]);
  state.SetLabel(std::string(stage_name(static_cast<Stage>(which))));
}
BENCHMARK(stage)
    ->Arg(static_cast<int>(Stage::integrate))
    ->Arg(static_cast<int>(Stage::solve))
    ->Arg(static_cast<int>(Stage::finish))
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->MinTime(0.2);

}  // namespace
}  // namespace souple
