// Cost of each pass of a picture of a liquid: a pool with a wave that fills most of the picture.
//   liquid_passes [--particles N] [--size WIDTHxHEIGHT] [--runs N] [--picture FILE.png]
// Prints the medians in milliseconds, for both splats and each filter, and the time of shaping the
// ellipsoids.

#include "render/context.h"
#include "render/display.h"
#include "render/image.h"
#include "render/renderer.h"
#include "souple/error.h"
#include "souple/surface/splat_shapes.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <string>
#include <vector>

namespace souple::render {
namespace {

struct Options {
  int particles = 100000, width = 1280, height = 720, runs = 5;
  std::string picture;
};

/// Height of the water at a point of the pool, which is 2 m long and 0.8 m wide. [m]
float height_of_water(float x, float z) {
  const float from_crest = (x + 0.55f + 0.1f * z) / 0.28f;
  return 0.16f + 0.34f * std::exp(-from_crest * from_crest) + 0.012f * std::sin(19 * x + 5 * z);
}

/// A number in [-0.5, 0.5) for each i.
float noise(std::uint32_t i) {
  i = (i ^ 61u ^ (i >> 16)) * 9u;
  i = (i ^ (i >> 4)) * 0x27d4eb2du;
  return float((i ^ (i >> 15)) >> 8) / float(1 << 24) - 0.5f;
}

std::vector<Vec3f> pool(float spacing) {
  std::vector<Vec3f> centers;
  std::uint32_t number = 0;
  for (float x = -1 + spacing / 2; x < 1; x += spacing)
    for (float z = -0.4f + spacing / 2; z < 0.4f; z += spacing)
      for (float y = spacing / 2; y < height_of_water(x, z); y += spacing) {
        const Vec3f moved{noise(number), noise(number + 1), noise(number + 2)};
        number += 3;
        centers.push_back(Vec3f{x, y, z} + moved * (0.3f * spacing));
      }
  return centers;
}

/// The spacing at which the pool has about this many particles. [m]
float spacing_for(int particles) {
  const float coarse = 0.04f;
  return coarse * std::cbrt(float(pool(coarse).size()) / float(particles));
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// With two threads. [ms]
double shape(SplatShapes& shapes, const std::vector<Vec3f>& centers, int runs) {
  using Clock = std::chrono::steady_clock;
  const auto threads = make_threads(Threading::automatic, 2);
  shapes.build(centers, *threads);
  std::vector<double> times;
  for (int run = 0; run < runs; ++run) {
    const Clock::time_point start = Clock::now();
    shapes.build(centers, *threads);
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return median(times);
}

DrawList list_of(const std::vector<Vec3f>& centers, float spacing, const SplatShapes* shapes) {
  Liquid liquid;
  liquid.key = shapes != nullptr ? 2 : 1;
  liquid.centers = centers;
  liquid.spacing = spacing;
  liquid.radius = 0.75f * spacing;
  if (shapes != nullptr) {
    liquid.centers = shapes->centers();
    liquid.ellipsoids = shapes->axes();
  }
  DrawList list;
  list.liquids.push_back(liquid);
  return list;
}

void measure(Renderer& renderer, const DrawList& list, SplatShape splat, LiquidFilter filter,
             const Options& options) {
  Camera camera;
  camera.from = {-1.4f, 1.1f, 1.9f};
  camera.to = {-0.1f, 0.12f, 0};
  camera.fov = 40;
  RenderOptions rendering;
  rendering.liquid_filter = filter;
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> times;
  std::vector<double> sums;
  renderer.picture(list, camera, rendering, options.width, options.height);  // compiles the shaders
  for (int run = 0; run < options.runs; ++run) {
    double sum = 0;
    for (const PassTime& time : renderer.measure(list, camera, rendering, options.width, options.height)) {
      if (run == 0) order.push_back(time.pass);
      times[time.pass].push_back(1e3 * time.seconds);
      sum += 1e3 * time.seconds;
    }
    sums.push_back(sum);
  }
  const std::string name =
      std::string(splat_shape_name(splat)) + "-" + std::string(liquid_filter_name(filter));
  std::printf("%s\n", name.c_str());
  for (const std::string& pass : order) std::printf("  %-18s %8.2f ms\n", pass.c_str(), median(times[pass]));
  std::printf("  %-18s %8.2f ms\n", "all", median(sums));
  if (options.picture.empty()) return;
  rendering.samples = 8;
  write_png(name + "-" + options.picture,
            renderer.picture(list, camera, rendering, options.width, options.height));
}

Options read(int count, char** words) {
  Options options;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string word = words[i];
    char* end = nullptr;
    if (word == "--picture") {
      options.picture = words[i + 1];
      continue;
    }
    const long value = std::strtol(words[i + 1], &end, 10);
    if (value < 1 || value > 100000000) throw Error(word + ": expected a number above 0");
    if (word == "--particles") {
      options.particles = int(value);
    } else if (word == "--runs") {
      options.runs = int(value);
    } else if (word == "--size" && *end == 'x') {
      options.width = int(value);
      options.height = std::atoi(end + 1);
    } else {
      throw Error("no option " + word + "; there are --particles, --size, --runs, --picture");
    }
  }
  return options;
}

int run(int count, char** words) {
  const Options options = read(count, words);
  const OffscreenContext context;
  Renderer renderer;
  const float spacing = spacing_for(options.particles);
  const std::vector<Vec3f> centers = pool(spacing);
  std::printf("%s\n%zu particles, %dx%d, medians of %d\n", context_description().c_str(), centers.size(),
              options.width, options.height, options.runs);
  SplatShapes shapes(spacing);
  std::printf("shapes of ellipsoids  %8.2f ms\n", shape(shapes, centers, options.runs));
  for (const SplatShape splat : {SplatShape::spheres, SplatShape::ellipsoids}) {
    const DrawList list = list_of(centers, spacing, splat == SplatShape::ellipsoids ? &shapes : nullptr);
    for (std::size_t i = 0; i < liquid_filter_count; ++i)
      measure(renderer, list, splat, static_cast<LiquidFilter>(i), options);
  }
  return 0;
}

}  // namespace
}  // namespace souple::render

int main(int count, char** words) {
  try {
    return souple::render::run(count, words);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "liquid_passes: %s\n", error.what());
    return 1;
  }
}
