// Layers of cloth: the higher one comes to lie outside, however it begins, and stays there.
#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/collision/crossings.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple {
namespace {

constexpr double frame_time = 1.0 / 60;

std::size_t crossings(const World& world) {
  test::Tangle tangle;
  for (const ObjectId id : world.objects()) tangle.add(world.positions(id), world.mesh(id).triangles);
  return tangle.crossings();
}

// An open tube around Y, counter-clockwise from outside.
TriangleMesh tube(int around, int rows, double radius, double height) {
  TriangleMesh mesh;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * (i + 0.5 * j) / around;
      mesh.positions.push_back(
          {radius * std::cos(angle), height * (double(j) / (rows - 1) - 0.5), radius * std::sin(angle)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * around + i % around); };
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i < around; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      mesh.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return mesh;
}

struct Story {
  std::size_t at_first = 0, at_last = 0;  // edges through triangles
  int apart_after = -1;                   // frames
  float top_speed = 0;                    // m/s
};

Story tell(World& world, int frames) {
  Story story;
  story.at_first = crossings(world);
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = world.step(frame_time);
    EXPECT_TRUE(report.ok()) << report.message;
    for (const ObjectId id : world.objects())
      for (const Vec3f& v : world.velocities(id)) story.top_speed = std::max(story.top_speed, length(v));
    story.at_last = crossings(world);
    if (story.at_last > 0) story.apart_after = -1;
    if (story.at_last == 0 && story.apart_after < 0) story.apart_after = frame;
  }
  return story;
}

// By how much every vertex of one tube is farther from the axis than the other one there; the least of all.
// Angles and heights are looked up in the inner one's triangles by a ray from the axis.
float least_clearance(const World& world, ObjectId inner, ObjectId outer) {
  const auto x = world.positions(inner);
  float least = 1;
  for (const Vec3f& p : world.positions(outer)) {
    const Vec3d from{0, static_cast<double>(p.y), 0}, way = Vec3d(p) - from;
    for (const Triangle& t : world.triangles(inner)) {
      const Vec3d a(x[t[0]]), ab = Vec3d(x[t[1]]) - a, ac = Vec3d(x[t[2]]) - a, n = cross(ab, ac);
      const double speed = dot(way, n);
      if (!(std::abs(speed) > 1e-12)) continue;
      const double s = dot(a - from, n) / speed;
      const Vec3d hit = from + way * s - a;
      const double u = dot(cross(hit, ac), n) / dot(n, n), v = dot(cross(ab, hit), n) / dot(n, n);
      if (s <= 0 || u < 0 || v < 0 || u + v > 1) continue;
      least = std::min(least, static_cast<float>((1 - s) * length(way)));
    }
  }
  return least;
}

const ClothMaterial cotton{.areal_density = 0.2f, .thickness = 0.006f, .damping = 2};

struct Dressed {
  World world;
  ObjectId shirt{}, coat{};
};

// A column, a shirt around it and a coat that is narrower than the shirt.
Dressed dressed(double shirt_radius, const Transform& coat_placed, double coat_radius, int shirt_layer,
                int coat_layer, int threads = 1) {
  Dressed d{World({.gravity = {}, .threads = threads})};
  d.world.add_obstacle(tube(24, 8, 0.12, 1.0), {.thickness = 0.004f});
  d.shirt = d.world.add_cloth(tube(40, 24, shirt_radius, 0.6), cotton, {.name = "shirt", .layer = shirt_layer});
  ObjectOptions coat{.name = "coat", .layer = coat_layer};
  coat.transform = coat_placed;
  d.coat = d.world.add_cloth(tube(36, 20, coat_radius, 0.5), cotton, coat);
  return d;
}

TEST(Layers, ACoatThatBeginsInsideOfTheShirtComesOut) {
  Dressed d = dressed(0.17, {.translation = {0, 0.01, 0}}, 0.16, 1, 2);
  EXPECT_LT(least_clearance(d.world, d.shirt, d.coat), -0.008f);
  const Story story = tell(d.world, 180);
  EXPECT_EQ(story.at_first, 0u);
  EXPECT_EQ(story.at_last, 0u);
  EXPECT_GT(least_clearance(d.world, d.shirt, d.coat), 0);
  EXPECT_LT(story.top_speed, 5);
  std::printf("inside: apart after %d top %g clear %g\n", story.apart_after, double(story.top_speed),
              double(least_clearance(d.world, d.shirt, d.coat)));
}

TEST(Layers, ACoatHalfSunkIntoTheShirtComesOut) {
  Dressed d = dressed(0.17, {.translation = {0.012, 0.01, 0.007}}, 0.172, 1, 2);
  const Story story = tell(d.world, 180);
  EXPECT_GT(story.at_first, 100u);
  EXPECT_EQ(story.at_last, 0u);
  EXPECT_GT(least_clearance(d.world, d.shirt, d.coat), 0);
  EXPECT_LT(story.top_speed, 5);
  std::printf("sunk: apart after %d top %g clear %g\n", story.apart_after, double(story.top_speed),
              double(least_clearance(d.world, d.shirt, d.coat)));
}

}  // namespace
}  // namespace souple
