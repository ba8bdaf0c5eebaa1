#include "app/check_pictures.h"
#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "souple/geometry/measures.h"
#include "souple/objects/kind_traits.h"
#include "souple/scene/scene.h"
#include "souple/world/memory.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <fmt/core.h>

namespace souple::app {

namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string sides_text(const Vec3d& sides) {
  return fmt::format(", {:.3g} x {:.3g} x {:.3g} m", sides.x, sides.y, sides.z);
}

/// The sides of the bounding box along X, Y and Z.
std::string size_text(std::span<const Vec3f> positions) {
  if (positions.size() < 2) return {};
  const std::vector<Vec3d> points(positions.begin(), positions.end());
  return sides_text(bounding_box(points).size());
}

/// Sizes of a collider's shape, in the collider's frame; of a plane its normal at the start.
struct ShapeText {
  Quatd rotation;

  std::string operator()(const Plane& plane) const {
    const Vec3d n = normalized(rotate(rotation, Vec3d(plane.normal)));
    // Without the rounding of a rotation, and -0.
    const auto shown = [](double x) { return std::round(x * 1e6) / 1e6 + 0.0; };
    return fmt::format(", normal ({:.3g}, {:.3g}, {:.3g})", shown(n.x), shown(n.y), shown(n.z));
  }
  std::string operator()(const Sphere& sphere) const {
    return fmt::format(", radius {:.3g} m", sphere.radius);
  }
  std::string operator()(const Box& box) const { return sides_text(Vec3d(box.half_extents) * 2.0); }
  std::string operator()(const Capsule& capsule) const {
    return fmt::format(", radius {:.3g} m, length {:.3g} m with its caps", capsule.radius,
                       2 * (capsule.half_height + capsule.radius));
  }
  std::string operator()(const Cylinder& cylinder) const {
    return fmt::format(", radius {:.3g} m, length {:.3g} m", cylinder.radius, 2 * cylinder.half_height);
  }
  std::string operator()(const SignedDistanceField& field) const {
    return ", " + counted(field.triangles().size(), "triangle", "triangles") +
           sides_text(field.hi() - field.lo()) + fmt::format(", spacing {:.3g} m", field.spacing());
  }
};

void print_tie(const TieDescription& tie) {
  std::printf("  %s: %s%s to %s\n", tie.name.empty() ? "tie" : tie.name.c_str(),
              tie.stitch  ? "stitches "
              : tie.slide ? "slides, "
                          : "",
              tie.from.empty() ? "the world" : tie.from.c_str(), tie.to.c_str());
}

void print_joint(const AnyJointDescription& any) {
  const JointDescription& joint = common(any);
  std::printf("  %s: %s, %s to %s\n", joint.name.c_str(), std::string(kind_name(any)).c_str(),
              joint.from.empty() ? "the world" : joint.from.c_str(), joint.to.c_str());
}

void print_collider(const World& world, const ColliderDescription& collider) {
  const ColliderId id = world.find_collider(collider.name);
  const Shape& shape = world.shape(id);
  std::printf("  %s: %s%s%s\n", collider.name.c_str(), std::string(shape_name(shape)).c_str(),
              std::visit(ShapeText{world.collider_pose(id).rotation}, shape).c_str(),
              collider.keyframes.empty() ? "" : ", moving");
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
  if (!traits_of(world.kind(object)).driven) line += fmt::format(", {:.4g} kg", world.total_mass(object));
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
  check_pictures(scene);
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
  for (const ColliderDescription& collider : scene.colliders) print_collider(world, collider);
  if (!scene.joints.empty()) std::printf("joints:\n");
  for (const AnyJointDescription& joint : scene.joints) print_joint(joint);
  if (!scene.ties.empty()) std::printf("ties:\n");
  for (const TieDescription& tie : scene.ties) print_tie(tie);
  if (!diagnostics.empty()) std::printf("diagnostics:\n");
  for (const std::string& diagnostic : diagnostics) std::printf("  %s\n", diagnostic.c_str());
  std::printf("the scene is valid\n");
  return success;
}

}  // namespace souple::app
