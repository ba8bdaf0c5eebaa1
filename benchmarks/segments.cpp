// The segment-triangle tests, for the tables of docs/segment-triangle.md, as JSON.
//
//   segments [TRIES]          rates of each test, and leaks of rays; beside Embree where libembree-dev is installed
//   segments --paths [SHOTS]  what discrete detection lets through, with each test; and cloth that falls on a box

#include "benchmarks/segments.h"

#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/simd/instruction_set.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>

#if SOUPLE_EMBREE
#include <embree3/rtcore.h>
#endif

namespace souple::benchmarks {
namespace {

constexpr int triangle_count = 512;  // fits into the first-level cache
constexpr int segment_count = 64;
constexpr double shortest_try = 0.01;  // s
/// Rays from inside a ball: to each of its corners, and to the midpoint of each of its edges.
constexpr int corner_rays = 642, edge_rays = 1920;

/// Corners of triangles as the tests read them.
struct Columns {
  std::vector<float> corner[3][3];

  void add(int k, const Vec3f& x) {
    for (int j = 0; j < 3; ++j) corner[k][j].push_back(x[j]);
  }
  TriangleColumns view() const {
    TriangleColumns columns;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) columns.corner[k][j] = corner[k][j].data();
    columns.count = corner[0][0].size();
    return columns;
  }
};

/// Triangles one behind the other, and segments that pass through the bounding boxes of all triangles but hit
/// none. Even a bounding volume hierarchy has to test every triangle. Each triangle is half of a square.
struct Stack {
  Columns triangles;
  std::vector<Segment<float>> segments;

  Stack() {
    test::Random random(1);
    const auto uniform = [&](double lo, double hi) { return static_cast<float>(random.uniform(lo, hi)); };
    for (int i = 0; i < triangle_count; ++i) {
      const float z = static_cast<float>(i + 1) / static_cast<float>(triangle_count);
      const float corners[3][2] = {{-1, -1}, {1, -1}, {-1, 1}};
      for (int k = 0; k < 3; ++k) {
        const float x = corners[k][0] + uniform(-0.05, 0.05), y = corners[k][1] + uniform(-0.05, 0.05);
        triangles.add(k, {x, y, z + uniform(-0.01, 0.01)});
      }
    }
    for (int i = 0; i < segment_count; ++i) {
      const float x = uniform(0.4, 0.6), y = uniform(0.4, 0.6);
      const float dx = uniform(-0.1, 0.1);
      segments.push_back({{x, y, -1}, {dx, uniform(-0.1, 0.1), 3}});
    }
  }
};

struct Crossings {
  std::vector<float> t, weight[3], side;
  explicit Crossings(std::size_t count) : t(count), weight{t, t, t}, side(t) {}
  CrossingColumns columns() {
    return {t.data(), {weight[0].data(), weight[1].data(), weight[2].data()}, side.data()};
  }
};

/// Segment-triangle tests per second on one thread: the fastest of `tries`. `test_all` tests all segments once.
double rate_of(int tries, const std::function<void()>& test_all) {
  const auto seconds_of = [&](int repeats) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) test_all();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  int repeats = 1;
  while (seconds_of(repeats) < shortest_try) repeats *= 2;
  double least = seconds_of(repeats);
  for (int i = 1; i < tries; ++i) least = std::min(least, seconds_of(repeats));
  return std::round(double{triangle_count} * segment_count * repeats / least);
}

double rate_of(SegmentTest test, const Stack& stack, bool packed, int tries) {
  Crossings found(triangle_count);
  return rate_of(tries, [&] {
    for (const Segment<float>& segment : stack.segments)
      find_crossings(test, segment, stack.triangles.view(), found.columns(), packed);
  });
}

struct Leaks {
  int corners = 0, edges = 0;
};

/// Rays that leave a closed ball without a hit. It is far from the origin, so that its corners are not round numbers.
Leaks leaks_of(SegmentTest test) {
  const TriangleMesh mesh = sphere(3, 1);
  std::vector<Vec3f> x;
  Columns ball;
  for (const Vec3d& v : mesh.positions) x.emplace_back(v + Vec3d{21, -18, 27});
  for (const Triangle& triangle : mesh.triangles)
    for (int k = 0; k < 3; ++k) ball.add(k, x[triangle[static_cast<std::size_t>(k)]]);
  Crossings found(mesh.triangles.size());
  const Vec3f middle{21.1f, -18.2f, 26.7f};
  const auto escapes = [&](const Vec3f& target) {
    find_crossings(test, {middle, target - middle, 10}, ball.view(), found.columns());
    return std::all_of(found.side.begin(), found.side.end(), [](float side) { return side == 0; });
  };
  Leaks leaks;
  for (const Vec3f& corner : x) leaks.corners += escapes(corner);
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (const std::uint32_t a = t[k], b = t[(k + 1) % 3]; a < b)
        leaks.edges += escapes((x[a] + x[b]) * 0.5f);
  return leaks;
}

#if SOUPLE_EMBREE
/// Rate of Embree on one thread. Every segment passes through all bounding boxes: its hierarchy excludes none.
double embree_rate(const Stack& stack, RTCSceneFlags flags, int tries) {
  const RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangle_count));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangle_count));
  for (std::size_t i = 0; i < 3 * triangle_count; ++i) {
    indices[i] = static_cast<unsigned>(i);
    for (std::size_t j = 0; j < 3; ++j) vertices[3 * i + j] = stack.triangles.corner[i % 3][j][i / 3];
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(scene, flags);
  rtcCommitScene(scene);
  const double rate = rate_of(tries, [&] {
    for (const Segment<float>& segment : stack.segments) {
      RTCRayHit ray{};
      ray.ray.org_x = segment.origin.x, ray.ray.org_y = segment.origin.y, ray.ray.org_z = segment.origin.z;
      ray.ray.dir_x = segment.direction.x, ray.ray.dir_y = segment.direction.y;
      ray.ray.dir_z = segment.direction.z;
      ray.ray.tfar = segment.max_t, ray.ray.mask = ~0u;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene, &context, &ray);
      if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID)
        throw Error("Embree reports a hit for a segment that misses all triangles");
    }
  });
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return rate;
}
#endif

void print_rates(int tries) {
  const Stack stack;
  std::printf("{\"size\": %d, \"simd\": \"%s\", \"corner_rays\": %d, \"edge_rays\": %d", triangle_count,
              std::string(simd_name()).c_str(), corner_rays, edge_rays);
  for (const auto& [name, test] : segment_test_names)
    if (test == default_segment_test) std::printf(", \"default\": \"%s\"", name);
  std::printf(",\n \"tests\": {");
  for (const auto& [name, test] : segment_test_names) {
    const Leaks leaks = leaks_of(test);
    std::printf(
        "%s\n  \"%s\": {\"scalar_per_second\": %.0f, \"packed_per_second\": %.0f, \"corner_leaks\": %d, "
        "\"edge_leaks\": %d}",
        test == segment_test_names[0].second ? "" : ",", name, rate_of(test, stack, false, tries),
        rate_of(test, stack, true, tries), leaks.corners, leaks.edges);
  }
  std::printf("}");
#if SOUPLE_EMBREE
  std::printf(",\n \"embree\": {\"fast\": %.0f, \"robust\": %.0f}",
              embree_rate(stack, RTC_SCENE_FLAG_NONE, tries),
              embree_rate(stack, RTC_SCENE_FLAG_ROBUST, tries));
#endif
  std::printf("}\n");
}

}  // namespace
}  // namespace souple::benchmarks

int main(int argc, char** argv) try {
  const bool paths = argc > 1 && std::strcmp(argv[1], "--paths") == 0;
  const char* count = argc > (paths ? 2 : 1) ? argv[paths ? 2 : 1] : nullptr;
  if (paths) {
    souple::benchmarks::print_path_leaks(count != nullptr ? std::max(1LL, std::atoll(count)) : 1000000);
  } else {
    souple::benchmarks::print_rates(count != nullptr ? std::max(1, std::atoi(count)) : 10);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "segments: %s\n", error.what());
  return 1;
}
