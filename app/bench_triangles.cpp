#include "app/bench_sheets.h"
#include "app/bench_stages.h"
#include "souple/math/fnv1a.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace souple::app {

using scene_format::Json;

namespace {

std::uint64_t hash_of(const NearPairs& pairs) {
  std::uint64_t hash = fnv1a64_start;
  for (const auto* list : {&pairs.vertex_triangle, &pairs.edge_edge})
    hash = fnv1a64(std::as_bytes(std::span(*list)), hash);
  return hash;
}

/// Measurements per step.
struct Times {
  std::vector<double> whole, boxes, build, pairs;
};

Json stages_json(const Times& times) {
  Json stages = Json::object();
  stages.set("boxes", milliseconds(times.boxes));
  stages.set("build", milliseconds(times.build));
  stages.set("pairs", milliseconds(times.pairs));
  return stages;
}

constexpr auto all_collide = [](std::uint32_t, std::uint32_t) { return true; };

}  // namespace

Json measure_triangles(const BenchOptions& options) {
  Sheets sheets(options.size);
  const auto threads = make_threads(options.settings.threading, options.settings.threads);
  NearPairFinder finder;
  NearPairs pairs;
  Times times;
  for (int step = 0; step < options.warm_up + options.runs; ++step) {
    sheets.move_to(step);
    const auto start = std::chrono::steady_clock::now();
    finder.find(sheets.elements(), sheets.boxes(), all_collide, sheets.positions(), pairs, *threads);
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    if (step < options.warm_up) continue;
    times.whole.push_back(spent.count());
    times.boxes.push_back(finder.milliseconds().boxes);
    times.build.push_back(finder.milliseconds().build);
    times.pairs.push_back(finder.milliseconds().pairs);
  }
  const SurfaceElements& elements = sheets.elements();
  const auto count = [](std::size_t n) { return Json::whole(static_cast<std::int64_t>(n)); };
  Json found = Json::object(), result = Json::object();
  found.set("vertex_triangle", count(pairs.vertex_triangle.size()));
  found.set("edge_edge", count(pairs.edge_edge.size()));
  // A query finds all triangles near one vertex, or all edges near one edge.
  const auto queries = static_cast<double>(elements.vertices().size() + elements.edges().size());
  result.set("triangles", count(elements.triangles().size()));
  result.set("vertices", count(elements.vertices().size()));
  result.set("edges", count(elements.edges().size()));
  result.set("ms_per_step", milliseconds(times.whole));
  result.set("ms_fastest", milliseconds({*std::min_element(times.whole.begin(), times.whole.end())}));
  result.set("ms_per_stage", stages_json(times));
  result.set("pairs", std::move(found));
  result.set("queries_per_second", Json::of(std::round(queries / (median(times.whole) * 1e-3))));
  result.set("bytes", count(finder.bytes()));
  result.set("hash", hash_json(hash_of(pairs)));
  return result;
}

}  // namespace souple::app
