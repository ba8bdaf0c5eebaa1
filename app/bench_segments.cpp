#include "app/bench_segments.h"

#include "souple/geometry/builders.h"
#include "souple/simd/instruction_set.h"
#include "souple/version.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr int segment_count = 64;
constexpr double shortest_try = 0.01;  // s

/// Uniform in [lo, hi), with equal numbers on every machine.
class Uniform {
 public:
  float operator()(float lo, float hi) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * (static_cast<float>(state_ >> 40) / 16777216.0f);
  }

 private:
  std::uint64_t state_ = 1;
};

struct Crossings {
  std::vector<float> t, weight[3], side;
  explicit Crossings(std::size_t count) : t(count), weight{t, t, t}, side(t) {}
  CrossingColumns columns() {
    return {t.data(), {weight[0].data(), weight[1].data(), weight[2].data()}, side.data()};
  }
};

double seconds_of(SegmentTest test, const SegmentStack& stack, Crossings& found, bool packed, int repeats) {
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < repeats; ++i)
    for (const Segment<float>& segment : stack.segments)
      find_crossings(test, segment, stack.columns(), found.columns(), packed);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double rate_of(SegmentTest test, const SegmentStack& stack, bool packed, int runs) {
  Crossings found(stack.columns().count);
  int repeats = 1;
  while (seconds_of(test, stack, found, packed, repeats) < shortest_try) repeats *= 2;
  double least = seconds_of(test, stack, found, packed, repeats);
  for (int i = 1; i < runs; ++i) least = std::min(least, seconds_of(test, stack, found, packed, repeats));
  return static_cast<double>(stack.columns().count * stack.segments.size()) * repeats / least;
}

/// A ball far from the origin, so that its corners are not round numbers, as triangle columns.
struct Ball {
  std::vector<Vec3f> corners;
  std::vector<Triangle> triangles;
  std::vector<float> numbers[3][3];

  Ball() {
    const TriangleMesh mesh = sphere(3, 1);
    for (const Vec3d& v : mesh.positions) corners.emplace_back(v + Vec3d{21, -18, 27});
    triangles = mesh.triangles;
    for (const Triangle& triangle : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) numbers[k][j].push_back(corners[triangle[k]][j]);
  }
  TriangleColumns columns() const {
    TriangleColumns columns;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) columns.corner[k][j] = numbers[k][j].data();
    columns.count = triangles.size();
    return columns;
  }
};

void count_leaks(SegmentTest test, SegmentRate& rate) {
  const Ball ball;
  Crossings found(ball.triangles.size());
  const Vec3f middle{21.1f, -18.2f, 26.7f};
  const auto escapes = [&](const Vec3f& target) {
    find_crossings(test, {middle, target - middle, 10}, ball.columns(), found.columns());
    return std::all_of(found.side.begin(), found.side.end(), [](float side) { return side == 0; });
  };
  for (const Vec3f& corner : ball.corners) rate.corner_leaks += escapes(corner);
  for (const Triangle& t : ball.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a < b) rate.edge_leaks += escapes((ball.corners[a] + ball.corners[b]) * 0.5f);  // each edge once
    }
}

}  // namespace

SegmentStack::SegmentStack(int triangles) {
  Uniform uniform;
  for (int i = 0; i < triangles; ++i) {
    const float z = static_cast<float>(i + 1) / static_cast<float>(triangles);
    const float corners[3][2] = {{-1, -1}, {1, -1}, {-1, 1}};
    for (int k = 0; k < 3; ++k) {
      corner[k][0].push_back(corners[k][0] + uniform(-0.05f, 0.05f));
      corner[k][1].push_back(corners[k][1] + uniform(-0.05f, 0.05f));
      corner[k][2].push_back(z + uniform(-0.01f, 0.01f));
    }
  }
  for (int i = 0; i < segment_count; ++i) {
    const float x = uniform(0.4f, 0.6f), y = uniform(0.4f, 0.6f);
    segments.push_back({{x, y, -1}, {uniform(-0.1f, 0.1f), uniform(-0.1f, 0.1f), 3}});
  }
}

TriangleColumns SegmentStack::columns() const {
  TriangleColumns columns;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) columns.corner[k][j] = corner[k][j].data();
  columns.count = corner[0][0].size();
  return columns;
}

std::vector<SegmentRate> measure_segments(const SegmentStack& stack, int runs) {
  std::vector<SegmentRate> rates;
  for (const auto& [name, test] : segment_test_names) {
    rates.push_back({name, rate_of(test, stack, false, runs), rate_of(test, stack, true, runs)});
    count_leaks(test, rates.back());
  }
  return rates;
}

Json segments_json(int size, const std::vector<SegmentRate>& rates) {
  Json result = Json::object();
  result.set("name", Json::of(segments_name));
  result.set("size", Json::whole(size));
  result.set("threads", Json::whole(1));
  result.set("simd", Json::of(std::string(simd_name())));
  result.set("version", Json::of(version));
  for (const auto& [name, test] : segment_test_names)
    if (test == default_segment_test) result.set("default", Json::of(name));
  Json tests = Json::object();
  for (const SegmentRate& rate : rates) {
    Json entry = Json::object();
    entry.set("scalar_per_second", Json::of(std::round(rate.scalar)));
    entry.set("packed_per_second", Json::of(std::round(rate.packed)));
    entry.set("corner_leaks", Json::whole(rate.corner_leaks));
    entry.set("edge_leaks", Json::whole(rate.edge_leaks));
    tests.set(rate.name, std::move(entry));
  }
  result.set("tests", std::move(tests));
  result.set("corner_rays", Json::whole(corner_rays));
  result.set("edge_rays", Json::whole(edge_rays));
  return result;
}

void print_segments(const Json& result) {
  const std::string& chosen = result.find("default")->text;
  std::printf("segments: million segment-triangle tests per second, one thread, %.0f triangles\n",
              result.find("size")->number);
  std::printf("  %-20s %10s %10s %10s %10s\n", "", "scalar", result.find("simd")->text.c_str(), "corners",
              "edges");
  for (const scene_format::Member& test : result.find("tests")->members) {
    const auto number = [&](const char* key) { return test.value.find(key)->number; };
    std::printf("  %-20s %10.1f %10.1f %10.0f %10.0f%s\n", test.key.c_str(),
                number("scalar_per_second") / 1e6, number("packed_per_second") / 1e6, number("corner_leaks"),
                number("edge_leaks"), test.key == chosen ? "  the default" : "");
  }
  std::printf("  corners, edges: rays that leave a closed mesh without a hit, of %d and %d aimed at them\n",
              corner_rays, edge_rays);
}

}  // namespace souple::app
