#include "app/bench_stages.h"
#include "souple/fluid/neighbors.h"
#include "souple/math/fnv1a.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <utility>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr float radius = 1;  // m

/// Points of a stirred fluid: uniform in a cube, with a given mean number of others within the radius, away
/// from walls. Each step moves every point by at most a twentieth of the radius along each axis. The memory
/// order is that of the last step's sort.
class Points {
 public:
  explicit Points(int count) : positions_(static_cast<std::size_t>(count)) {
    // Away from walls; 29 on average of 100 000, including points at the walls.
    constexpr double neighbors = 30.5;
    const double volume = 4 * pi / 3 * std::pow(double{radius}, 3);
    const double side = std::cbrt(count * volume / neighbors);
    for (Vec4f& p : positions_) p = {uniform(side), uniform(side), uniform(side), 0};
  }
  void move() {
    constexpr double max_motion = 0.05 * double{radius};
    for (Vec4f& p : positions_) {
      p.x += uniform(2 * max_motion) - static_cast<float>(max_motion);
      p.y += uniform(2 * max_motion) - static_cast<float>(max_motion);
      p.z += uniform(2 * max_motion) - static_cast<float>(max_motion);
    }
  }
  void reorder(std::span<const std::uint32_t> order) {
    next_.clear();
    for (const std::uint32_t i : order) next_.push_back(positions_[i]);
    std::swap(next_, positions_);
  }
  std::span<const Vec4f> positions() const { return positions_; }

 private:
  // Own generator: the distributions of the standard library differ between implementations.
  float uniform(double below) {
    return static_cast<float>(below * static_cast<double>(random_()) / 4294967296.0);
  }

  std::mt19937 random_{1};
  std::vector<Vec4f> positions_, next_;
};

std::uint64_t hash_of(const Neighbors& neighbors) {
  std::uint64_t hash = fnv1a64_start;
  for (const Neighbors::Block& block : neighbors.blocks())
    for (std::uint32_t slot = block.begin; slot < block.end; ++slot)
      hash = fnv1a64(std::as_bytes(block.of(slot)), hash);
  return hash;
}

}  // namespace

Json measure_neighbors(const BenchOptions& options) {
  Points points(options.size);
  const auto threads = make_threads(options.settings.threading, options.settings.threads);
  CellOrder order;
  Neighbors neighbors;
  order.build(points.positions(), radius, *threads);
  std::vector<double> whole, sort, lists;
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto spent = [](auto from, auto to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
  };
  for (int step = 0; step < options.warm_up + options.runs; ++step) {
    points.reorder(order.order());
    points.move();
    const auto start = now();
    order.build(points.positions(), radius, *threads);
    const auto sorted = now();
    neighbors.find(order, radius, *threads);
    const auto end = now();
    if (step < options.warm_up) continue;
    whole.push_back(spent(start, end));
    sort.push_back(spent(start, sorted));
    lists.push_back(spent(sorted, end));
  }
  const auto count = static_cast<double>(neighbors.count());
  Json stages = Json::object(), result = Json::object();
  stages.set("sort", milliseconds(sort));
  stages.set("lists", milliseconds(lists));
  result.set("ms_per_step", milliseconds(whole));
  result.set("ms_fastest", milliseconds({*std::min_element(whole.begin(), whole.end())}));
  result.set("ms_per_stage", std::move(stages));
  result.set("neighbors", Json::of(std::round(100 * count / options.size) / 100));
  result.set("pairs_per_second", Json::of(std::round(count / (median(lists) * 1e-3))));
  result.set("bytes", Json::whole(static_cast<std::int64_t>(order.bytes() + neighbors.bytes())));
  result.set("hash", hash_json(hash_of(neighbors)));
  return result;
}

}  // namespace souple::app
