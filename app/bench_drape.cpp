#include "app/bench_stages.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

namespace souple::app {

using scene_format::Json;

namespace {

constexpr double frame = 1.0 / 60;  // s
constexpr int passes = 2;           // of each scene; the faster time of each frame counts
constexpr double top = 0.5;         // m, of every collider
constexpr double drop = 0.02;       // m

/// A ball of 0.25 m with bumps that are smaller than a triangle of a coarse cloth.
TriangleMesh bumpy_ball() {
  TriangleMesh mesh = sphere(4, 0.22);
  for (Vec3d& x : mesh.positions)
    x = x * (1 + 0.12 * std::sin(16 * x.x) * std::sin(16 * x.y + 1) * std::sin(16 * x.z + 2));
  return mesh;
}

struct Obstacle {
  const char* name;
  Shape shape;
  double height;  ///< of its frame's origin, for its top to be at `top` [m]
  Quatd rotation{};
};

std::array<Obstacle, 6> obstacles() {
  const Quatd lying = Quatd::from_axis_angle({1, 0, 0}, 1.5707963267948966);
  return {{{"plane", Plane{}, top},
           {"sphere", Sphere{{}, 0.22f}, top - 0.22},
           {"box", Box{{}, {0.25f, 0.25f, 0.25f}}, top - 0.25},
           {"capsule", Capsule{{}, 0.15f, 0.2f}, top - 0.15, lying},
           {"cylinder", Cylinder{{}, 0.25f, 0.25f}, top - 0.25},
           {"field", SignedDistanceField(bumpy_ball(), 0.01), top - 0.22}}};
}

struct Frames {
  std::vector<double> milliseconds;
  std::uint64_t hash = 0;

  double mean() const {
    double sum = 0;
    for (const double ms : milliseconds) sum += ms;
    return sum / static_cast<double>(milliseconds.size());
  }
  double worst() const { return *std::max_element(milliseconds.begin(), milliseconds.end()); }
};

/// Cotton of 1 m that falls on an obstacle, or without one past its place.
World drape(const BenchOptions& options, const Obstacle* obstacle) {
  Settings settings = options.settings;
  settings.measure_residuals = false;
  World world(settings);
  world.add_cloth(grid(options.size, options.size, 1), material::cotton,
                  {.transform = {.translation = {0.013, top + drop, 0.007}}});
  if (obstacle == nullptr) return world;
  ColliderOptions collider;
  collider.friction = 0.4f;
  collider.motion =
      ColliderMotion::fixed({.translation = {0, obstacle->height, 0}, .rotation = obstacle->rotation});
  world.add_collider(obstacle->shape, collider);
  return world;
}

Frames measure_frames(const BenchOptions& options, const Obstacle* obstacle) {
  Frames frames;
  frames.milliseconds.assign(static_cast<std::size_t>(options.runs), std::numeric_limits<double>::infinity());
  for (int pass = 0; pass < passes; ++pass) {
    World world = drape(options, obstacle);
    for (int i = 0; i < options.warm_up; ++i) world.step(frame);
    for (double& ms : frames.milliseconds) {
      const auto start = std::chrono::steady_clock::now();
      world.step(frame);
      ms = std::min(
          ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    frames.hash = world.hash();
  }
  return frames;
}

Json ratio(double with, double without) {
  return Json::of(std::round(with / without * 1e3) / 1e3);
}

Json frames_json(const Frames& with, const Frames& without) {
  Json result = Json::object();
  result.set("ms_mean", milliseconds({with.mean()}));
  result.set("ms_worst", milliseconds({with.worst()}));
  result.set("over_free", ratio(with.mean(), without.mean()));
  result.set("worst_over_free", ratio(with.worst(), without.worst()));
  result.set("hash", hash_json(with.hash));
  return result;
}

}  // namespace

Json measure_drape(const BenchOptions& options) {
  const Frames free = measure_frames(options, nullptr);
  Json result = Json::object(), shapes = Json::object();
  shapes.set("free", frames_json(free, free));
  double sum = 0;
  const auto all = obstacles();
  for (const Obstacle& obstacle : all) {
    const Frames frames = measure_frames(options, &obstacle);
    shapes.set(obstacle.name, frames_json(frames, free));
    sum += frames.mean();
  }
  result.set("ms_per_step", milliseconds({sum / double(all.size())}));
  result.set("shapes", std::move(shapes));
  return result;
}

}  // namespace souple::app
