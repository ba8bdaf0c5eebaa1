#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <cstdio>

#include <fmt/core.h>

namespace souple::app {

namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void print_object(const World& world, ObjectId object) {
  std::string line = "  " + world.name(object) + ": " + std::string(kind_name(world.kind(object))) + ", " +
                     counted(world.positions(object).size(), "vertex", "vertices");
  const std::size_t triangles = world.triangles(object).size();
  if (triangles > 0) line += ", " + counted(triangles, "triangle", "triangles");
  const std::size_t pinned = world.pinned(object).size();
  if (pinned > 0) line += fmt::format(", {} pinned", pinned);
  std::printf("%s, %.4g kg\n", line.c_str(), world.total_mass(object));
}

}  // namespace

int check(const std::string& scene_name, const std::vector<std::string>& settings) {
  const SceneDescription scene = load_scene(find_scene(scene_name), settings);
  std::vector<std::string> diagnostics;
  const World world = build_world(
      scene, [&](LogLevel, std::string_view diagnostic) { diagnostics.emplace_back(diagnostic); });

  std::printf("%s\n", scene.source.c_str());
  if (!scene.description.empty()) std::printf("%s\n", scene.description.c_str());
  std::printf(
      "%s of %.4g ms, %s of %s\n", counted(scene.frames, "frame", "frames").c_str(), 1e3 / scene.frame_rate,
      counted(static_cast<std::size_t>(scene.settings.substeps), "substep", "substeps").c_str(),
      counted(static_cast<std::size_t>(scene.settings.iterations), "iteration", "iterations").c_str());
  std::printf("objects:\n");
  for (const ObjectId object : world.objects()) print_object(world, object);
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
