#include "souple/collision/continuous.h"

#include "souple/collision/cubic.h"
#include "souple/collision/nearest.h"
#include "tests/collision/random.h"

#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

// Nanoseconds per call of continuous detection: safe times by outcome, the cubic alone, and nearest points in float and in
// double.

namespace souple {

namespace {

using test::Random;

enum Case { boxes, apart, turning, crossing };

/// A particle a millimeter to a centimeter above a triangle (or edges that cross at such a distance), as in
/// cloth.
Moving4 motion(Case kind, bool edges, Random& random) {
  Moving4 m;
  const int upper = edges ? 2 : 1;
  for (int i = 0; i < 4; ++i) {
    m.x[i] = random.point(-0.01, 0.01);
    m.x[i].y = i < upper ? 0.002 : 0;
  }
  if (edges) {
    m.x[0].x = -0.01, m.x[1].x = 0.01, m.x[2].z = -0.01, m.x[3].z = 0.01;
  } else {
    m.x[0] = (m.x[1] + m.x[2] + m.x[3]) * (1.0 / 3) + Vec3d{0, 0.002, 0};
  }
  for (int i = 0; i < 4; ++i) {
    m.p[i] = m.x[i] + random.point(-0.0002, 0.0002);
    if (i < upper && kind == crossing) m.p[i].y -= 0.006;
    // Rotated during the motion: no single direction separates them.
    if (kind == turning) m.p[i] = Vec3d{m.p[i].x, m.p[i].z, -m.p[i].y} + random.point(-0.0002, 0.0002);
  }
  // Oblique, so that the bounding boxes overlap.
  const auto tilt = [](Vec3d& v) { v = {v.x * 0.8 - v.y * 0.6, v.x * 0.6 + v.y * 0.8, v.z + 0.8 * v.y}; };
  for (int i = 0; i < 4 && kind != boxes; ++i) tilt(m.x[i]), tilt(m.p[i]);
  return m;
}

void safe_time(benchmark::State& state, Case kind, bool edges) {
  Random random(1);
  std::vector<Moving4> motions;
  for (int i = 0; i < 1024; ++i) motions.push_back(motion(kind, edges, random));
  double sum = 0;
  std::size_t i = 0, free = 0;
  for (auto _ : state) {
    const Moving4& m = motions[i++ % motions.size()];
    const double t = edges ? edge_edge_time(m, 0.0005) : vertex_triangle_time(m, 0.0005);
    sum += t;
    free += t == 1;
  }
  benchmark::DoNotOptimize(sum);
  state.counters["collision_free"] = double(free) / double(i);
}
BENCHMARK_CAPTURE(safe_time, vertex_triangle_boxes, boxes, false);
BENCHMARK_CAPTURE(safe_time, vertex_triangle_apart, apart, false);
BENCHMARK_CAPTURE(safe_time, vertex_triangle_turning, turning, false);
BENCHMARK_CAPTURE(safe_time, vertex_triangle_hit, crossing, false);
BENCHMARK_CAPTURE(safe_time, edge_edge_boxes, boxes, true);
BENCHMARK_CAPTURE(safe_time, edge_edge_apart, apart, true);
BENCHMARK_CAPTURE(safe_time, edge_edge_turning, turning, true);
BENCHMARK_CAPTURE(safe_time, edge_edge_hit, crossing, true);

void roots(benchmark::State& state) {
  Random random(2);
  std::vector<double> c(4096);
  for (double& v : c) v = random.uniform(-1, 1);
  std::size_t i = 0;
  for (auto _ : state) {
    const double* at = &c[i++ % 1024 * 4];
    benchmark::DoNotOptimize(cubic_roots({at[0], at[1], at[2], at[3]}));
  }
}
BENCHMARK(roots);

template <class T>
void triangle_weights(benchmark::State& state) {
  Random random(3);
  std::vector<Vec3<T>> x;
  for (int i = 0; i < 1024; ++i) x.emplace_back(random.point(-1, 1));
  std::size_t i = 0;
  for (auto _ : state) {
    const Vec3<T>* at = &x[i++ % 256 * 4];
    T weight[3];
    nearest_on_triangle(at[0], at[1], at[2], at[3], weight);
    benchmark::DoNotOptimize(weight);
  }
}
BENCHMARK_TEMPLATE(triangle_weights, float);
BENCHMARK_TEMPLATE(triangle_weights, double);

template <class T>
void edge_parameters(benchmark::State& state) {
  Random random(4);
  std::vector<Vec3<T>> x;
  for (int i = 0; i < 1024; ++i) x.emplace_back(random.point(-1, 1));
  std::size_t i = 0;
  for (auto _ : state) {
    const Vec3<T>* at = &x[i++ % 256 * 4];
    T s, t;
    nearest_on_edges(at[0], at[1], at[2], at[3], s, t);
    benchmark::DoNotOptimize(s);
    benchmark::DoNotOptimize(t);
  }
}
BENCHMARK_TEMPLATE(edge_parameters, float);
BENCHMARK_TEMPLATE(edge_parameters, double);

}  // namespace
}  // namespace souple
