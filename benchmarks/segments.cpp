// The segment-triangle tests of Souple beside Embree's, in one run, on the triangles of `souple bench
// segments`: every segment passes through all bounding boxes, so that Embree's hierarchy excludes none and
// all triangles are tested.
//   segments [--size N] [--runs N] [--json]

#include "app/bench_segments.h"
#include "souple/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <embree3/rtcore.h>
#include <exception>

namespace souple::app {
namespace {

/// The triangles in an Embree scene on one thread.
class EmbreeScene {
 public:
  EmbreeScene(const SegmentStack& stack, RTCSceneFlags flags)
      : device_(rtcNewDevice("threads=1,set_affinity=0")), scene_(rtcNewScene(device_)) {
    const TriangleColumns columns = stack.columns();
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * columns.count));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), columns.count));
    for (std::size_t i = 0; i < columns.count; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        indices[3 * i + k] = static_cast<unsigned>(3 * i + k);
        for (std::size_t j = 0; j < 3; ++j) vertices[3 * (3 * i + k) + j] = columns.corner[k][j][i];
      }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, flags);
    rtcCommitScene(scene_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  bool hits(const Segment<float>& segment) const {
    RTCRayHit ray{};
    ray.ray.org_x = segment.origin.x, ray.ray.org_y = segment.origin.y, ray.ray.org_z = segment.origin.z;
    ray.ray.dir_x = segment.direction.x, ray.ray.dir_y = segment.direction.y;
    ray.ray.dir_z = segment.direction.z;
    ray.ray.tfar = segment.max_t, ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

/// Seconds for all rays, one after another.
double seconds_of(const EmbreeScene& scene, const SegmentStack& stack, int repeats) {
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < repeats; ++i)
    for (const Segment<float>& segment : stack.segments)
      if (scene.hits(segment)) throw Error("Embree reports a hit for a segment that misses all triangles");
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double rate_of(const SegmentStack& stack, RTCSceneFlags flags, int runs) {
  const EmbreeScene scene(stack, flags);
  int repeats = 1;
  while (seconds_of(scene, stack, repeats) < 0.01) repeats *= 2;
  double least = seconds_of(scene, stack, repeats);
  for (int i = 1; i < runs; ++i) least = std::min(least, seconds_of(scene, stack, repeats));
  return static_cast<double>(stack.columns().count * stack.segments.size()) * repeats / least;
}

scene_format::Json measure(int size, int runs) {
  using scene_format::Json;
  const SegmentStack stack(size);
  Json result = segments_json(size, measure_segments(stack, runs));
  Json embree = Json::object();
  embree.set("fast", Json::of(std::round(rate_of(stack, RTC_SCENE_FLAG_NONE, runs))));
  embree.set("robust", Json::of(std::round(rate_of(stack, RTC_SCENE_FLAG_ROBUST, runs))));
  result.set("embree", std::move(embree));
  return result;
}

void print(const scene_format::Json& result) {
  print_segments(result);
  for (const scene_format::Member& member : result.find("embree")->members)
    std::printf("  Embree, %-12s %10s %10.1f  including traversal of its boxes\n", member.key.c_str(), "",
                member.value.number / 1e6);
}

}  // namespace
}  // namespace souple::app

int main(int argc, char** argv) try {
  int size = souple::app::default_segments_size, runs = 10;
  bool json = false;
  for (int i = 1; i < argc; ++i) {
    const auto is = [&](const char* option) { return std::strcmp(argv[i], option) == 0; };
    if (is("--json")) json = true;
    if (is("--size") && i + 1 < argc) size = std::max(1, std::atoi(argv[++i]));
    if (is("--runs") && i + 1 < argc) runs = std::max(1, std::atoi(argv[++i]));
  }
  const auto result = souple::app::measure(size, runs);
  if (json) {
    std::fputs(souple::scene_format::dump_json(result).c_str(), stdout);
  } else {
    souple::app::print(result);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "segments: %s\n", error.what());
  return 1;
}
