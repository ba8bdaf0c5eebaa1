#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "souple/geometry/measures.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <cstdio>
#include <span>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// The sides of the bounding box along X, Y and Z.
std::string size_text(std::span<const Vec3f> positions) {
  if (positions.size() < 2) return {};
  const std::vector<Vec3d> points(positions.begin(), positions.end());
  const Vec3d sides = bounding_box(points).size();
  return fmt::format(", {:.3g} x {:.3g} x {:.3g} m", sides.x, sides.y, sides.z);
}

std::string tets_text(const World::TetStatistics& statistics) {
  if (statistics.tets == 0) return {};
  const std::string tets = counted(statistics.tets, "tet", "tets");
  if (!(statistics.cell_size > 0)) return ", " + tets;
  return fmt::format(", lattice of {} and {} with cells of {:.3g} m", tets,
                     counted(statistics.particles, "particle", "particles"), statistics.cell_size);
}

void print_object(const World& world, ObjectId object) {
  std::string line = "  " + world.name(object) + ": " + std::string(kind_name(world.kind(object))) + ", " +
                     counted(world.positions(object).size(), "vertex", "vertices");
  const std::size_t triangles = world.triangles(object).size();
  if (triangles > 0) line += ", " + counted(triangles, "triangle", "triangles");
  const std::size_t pinned = world.pinned(object).size();
  if (pinned > 0) line += fmt::format(", {} pinned", pinned);
  line += tets_text(world.tet_statistics(object)) + size_text(world.positions(object));
  if (world.kind(object) != ObjectKind::obstacle)
    line += fmt::format(", {:.4g} kg", world.total_mass(object));
  std::printf("%s\n", line.c_str());
}

void print_totals(World& world) {
  double mass = 0;
  for (const ObjectId object : world.objects()) mass += world.total_mass(object);
  std::printf("total: %s, %.4g kg\n", counted(world.memory().particles, "particle", "particles").c_str(),
              mass);
}

}  // namespace

int check(const std::string& scene_name, const std::vector<std::string>& settings) {
  const SceneDescription scene = load_scene(find_scene(scene_name), settings);
  std::vector<std::string> diagnostics;
  World world = build_world(
      scene, [&](LogLevel, std::string_view diagnostic) { diagnostics.emplace_back(diagnostic); });

  std::printf("%s\n", scene.source.c_str());
  if (!scene.description.empty()) std::printf("%s\n", scene.description.c_str());
  std::printf(
      "%s of %.4g ms, %s of %s\n", counted(scene.frames, "frame", "frames").c_str(), 1e3 / scene.frame_rate,
      counted(static_cast<std::size_t>(scene.settings.substeps), "substep", "substeps").c_str(),
      counted(static_cast<std::size_t>(scene.settings.iterations), "iteration", "iterations").c_str());
  std::printf("objects:\n");
  for (const ObjectId object : world.objects()) print_object(world, object);
  print_totals(world);
  if (!scene.colliders.empty()) std::printf("colliders:\n");
  for (const ColliderDescription& collider : scene.colliders) {
    std::printf("  %s: %s%s\n", collider.name.c_str(), std::string(shape_name(collider.shape)).c_str(),
                collider.keyframes.empty() ? "" : ", moving");
  }
  if (!diagnostics.empty()) std::printf("diagnostics:\n");
  for (const std::string& diagnostic : diagnostics) std::printf("  %s\n", diagnostic.c_str());
  std::printf("the scene is valid\n");
  return success;
}

}  // namespace souple::app
