// Leaks of discrete detection: grains shot at the shared corners and edges of a ball's triangles, with each segment-triangle
// test. A cloth that falls on a box follows.
//
// A shot starts within the ball, near the corner or the middle of the edge that it aims at, and would end outside. Balls have
// 1280 triangles and 1 m. They are turned and moved at random, about 5 m from the origin.

#include "benchmarks/segments.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/collision/random.h"
#include "tests/intersections/crossings.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <vector>

namespace souple::benchmarks {
namespace {

struct Ball {
  TriangleMesh mesh;
  Vec3d center;
};

Ball random_ball(test::Random& random) {
  Ball ball{sphere(3, 1), random.point(-5, 5)};
  const Vec3d x = normalized(random.point(-1, 1)), z = normalized(cross(x, random.point(-1, 1)));
  const Vec3d y = cross(z, x);
  for (Vec3d& p : ball.mesh.positions) p = ball.center + x * p.x + y * p.y + z * p.z;
  return ball;
}

// As the obstacle has them: in float.
std::vector<Vec3f> targets(const TriangleMesh& mesh, bool at_edges) {
  std::vector<Vec3f> result;
  if (!at_edges)
    for (const Vec3d& p : mesh.positions) result.emplace_back(p);
  else
    for (const Edge& edge : unique_edges(mesh.triangles))
      result.push_back((Vec3f(mesh.positions[edge[0]]) + Vec3f(mesh.positions[edge[1]])) * 0.5f);
  return result;
}

struct Count {
  long long shots = 0, through = 0;
};

// One shot at each target, within one substep.
void shoot(SegmentTest segment_test, const Ball& ball, bool at_edges, test::Random& random, Count& count) {
  constexpr double dt = 1.0 / 60, outside = 1.05;
  World world({.substeps = 1,
               .gravity = {},
               .measure_residuals = false,
               .detection = Detection::discrete,
               .segment_test = segment_test,
               .threads = 1});
  world.add_obstacle(ball.mesh, {.thickness = 1e-4f});
  std::vector<Vec3d> start;
  std::vector<Vec3f> velocity;
  for (const Vec3f& target : targets(ball.mesh, at_edges)) {
    const Vec3d aim(target), from = ball.center + (aim - ball.center) * 0.85 + random.point(-0.05, 0.05);
    start.push_back(from);
    velocity.push_back((target - Vec3f(from)) * static_cast<float>(2 / dt));
  }
  const ObjectId grains = world.add_grains(start, {.radius = 1e-4f}, {.name = "grains"});
  world.set_collide("grains", "grains", false);
  world.set_velocities(grains, velocity);
  world.step(dt);
  for (const Vec3f& x : world.positions(grains)) {
    ++count.shots;
    count.through += length(Vec3d(x) - ball.center) > outside;
  }
}

Count leaks(SegmentTest segment_test, bool at_edges, long long shots) {
  test::Random random(1);
  Count count;
  while (count.shots < shots) shoot(segment_test, random_ball(random), at_edges, random, count);
  return count;
}

std::size_t crossings(const World& world, std::span<const ObjectId> objects) {
  test::CrossingCounter counter;
  for (const ObjectId id : objects) counter.add(world.positions(id), world.triangles(id));
  return counter.crossings();
}

// Cotton of 1 m falls on a box for 2 s: vertices in the box, and edges of one through triangles of the other.
void print_cloth(Detection detection) {
  World world({.detection = detection, .threads = 1});
  const ObjectId obstacle = world.add_obstacle(box({0.5, 0.5, 0.5}));
  const ObjectId cloth = world.add_cloth(grid(30, 30, 1), material::cotton,
                                         {.transform = {.translation = {0.05f, 0.3f, 0.02f}}});
  for (int frame = 0; frame < 120; ++frame) world.step(1.0 / 60);
  int inside = 0;
  for (const Vec3f& x : world.positions(cloth))
    inside += std::fabs(x.x) < 0.25f && std::fabs(x.y) < 0.25f && std::fabs(x.z) < 0.25f;
  const std::size_t together = crossings(world, std::array{obstacle, cloth});
  std::printf("{\"detection\": \"%s\", \"vertices\": 900, \"inside\": %d, \"crossings\": %zu}",
              detection == Detection::discrete ? "discrete" : "continuous", inside,
              together - crossings(world, std::array{cloth}));
}

}  // namespace

void print_path_leaks(long long shots) {
  std::printf("{\"tests\": [");
  for (const auto& [name, segment_test] : segment_test_names) {
    const Count corners = leaks(segment_test, false, shots), edges = leaks(segment_test, true, shots);
    std::printf(
        "%s\n  {\"name\": \"%s\", \"corner_shots\": %lld, \"corners\": %lld, \"edge_shots\": %lld, "
        "\"edges\": %lld}",
        segment_test == segment_test_names[0].second ? "" : ",", name, corners.shots, corners.through,
        edges.shots, edges.through);
    std::fflush(stdout);
  }
  std::printf("],\n \"cloth\": [");
  print_cloth(Detection::continuous);
  std::printf(", ");
  print_cloth(Detection::discrete);
  std::printf("]}\n");
}

}  // namespace souple::benchmarks
