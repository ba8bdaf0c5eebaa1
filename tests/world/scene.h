#pragma once

#include "souple/souple.h"
#include "tests/intersections/crossings.h"

#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

// Helpers that tests of worlds share.

namespace souple {

inline ObjectOptions at(const Vec3d& translation) {
  ObjectOptions options;
  options.transform.translation = translation;
  return options;
}

inline ObjectOptions at(double x, double y, double z) {
  return at(Vec3d{x, y, z});
}

inline ClothMaterial thick_cloth() {
  ClothMaterial material = material::cotton;
  material.thickness = 0.01f;
  return material;
}

inline World on_the_ground() {
  World world({.threads = 1});
  world.add_collider(Plane{});
  return world;
}

using test::crossings;

inline const Box small_box{{}, {0.1f, 0.1f, 0.1f}};

template <class Function>
void change(World& world, const Function& set) {
  Settings settings = world.settings();
  set(settings);
  world.set_settings(settings);
}

/// In frames of 1/60 s.
inline void run(World& world, double seconds) {
  for (int frame = 0; frame < std::lround(seconds * 60); ++frame) world.step(1.0 / 60);
}

inline std::vector<Vec3f> copy(std::span<const Vec3f> vectors) {
  return {vectors.begin(), vectors.end()};
}

inline Vec3d total_momentum(const World& world) {
  Vec3d sum;
  for (const ObjectId id : world.objects()) sum += world.momentum(id);
  return sum;
}

/// A world that is restored goes on with equal bits: itself, and one that is built again.
template <class Build>
void expect_resumes(const Build& build, double seconds_before, double seconds_after) {
  World world = build(), again = build();
  run(world, seconds_before);
  const Snapshot snapshot = world.snapshot();
  run(world, seconds_after);
  const std::uint64_t end = world.hash();
  again.restore(snapshot);
  run(again, seconds_after);
  EXPECT_EQ(again.hash(), end) << "built again";
  world.restore(snapshot);
  run(world, seconds_after);
  EXPECT_EQ(world.hash(), end) << "rolled back";
}

}  // namespace souple
