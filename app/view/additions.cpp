#include "app/view/additions.h"

#include "souple/error.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/measures.h"
#include "souple/math/scalar.h"
#include "souple/mesh_files/mesh_file.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>

namespace souple::viewer {

namespace {

constexpr std::uint32_t warm = 0xf0a35e;
constexpr double g = 9.81;  // m/s^2

template <class Description>
Description named(const char* name) {
  Description description;
  description.name = name;
  return description;
}

/// Contact distances that suit an object of this size [m].
template <class Material>
void fit_thickness(Material& material, double size) {
  material.thickness = std::min(material.thickness, static_cast<float>(0.01 * size));
}

SoftBodyDescription stiff(const char* name, double size) {
  auto body = named<SoftBodyDescription>(name);
  body.material.model = SoftBodyModel::shape_matching;
  body.material.young_modulus = 1e7f;
  body.material.density = 500;
  fit_thickness(body.material, size);
  return body;
}

NewObject cloth(double size) {
  auto sheet = named<ClothDescription>("cloth");
  sheet.mesh.source = GridMesh{24, 24, size};
  static_cast<ClothMaterial&>(sheet.material) = material::cotton;
  sheet.material.preset = "cotton";
  fit_thickness(sheet.material, size);
  sheet.self_collision = SelfCollision::surfaces;
  return {std::move(sheet), {}, size * std::sqrt(0.5)};
}

NewObject soft_ball(double size) {
  auto ball = named<SoftBodyDescription>("soft_ball");
  ball.mesh.source = TetBallMesh{3, 3, size / 2};
  static_cast<SoftBodyMaterial&>(ball.material) = material::jelly;
  ball.material.preset = "jelly";
  // A large ball of jelly would be a puddle.
  const double weight = static_cast<double>(ball.material.density) * g * size;  // Pa
  ball.material.young_modulus = std::max(ball.material.young_modulus, static_cast<float>(5 * weight));
  fit_thickness(ball.material, size);
  return {std::move(ball), {}, size / 2};
}

NewObject stiff_box(double size) {
  auto body = stiff("box", size);
  const double side = 0.6 * size;
  body.mesh.source = TetBarMesh{{3, 3, 3}, {side, side, side}};
  return {std::move(body), {}, side * std::sqrt(0.75)};
}

NewObject rope(double size) {
  auto line = named<RopeDescription>("rope");
  line.points = {{-size / 2, 0, 0}, {size / 2, 0, 0}};
  line.segments = 40;
  static_cast<RopeMaterial&>(line.material) = material::nylon;
  line.material.preset = "nylon";
  line.material.radius = std::min(line.material.radius, static_cast<float>(size / 100));
  line.self_collision = SelfCollision::surfaces;
  return {std::move(line), {}, size / 2};
}

NewObject grains(double size) {
  auto heap = named<GrainsDescription>("grains");
  GrainsGrid lattice;
  lattice.counts = {4, 4, 4};
  heap.centers = lattice;
  static_cast<GrainsMaterial&>(heap.material) = material::sand;
  heap.material.preset = "sand";
  heap.material.radius = static_cast<float>(size / 10);
  return {std::move(heap), {}, 0.4 * size * std::sqrt(3.0)};
}

struct AdditionKind {
  const char* label;
  NewObject (*described)(double size);
};
/// In the order of Addition.
constexpr std::array<AdditionKind, all_additions.size()> addition_kinds{{{"Cloth", cloth},
                                                                         {"Soft ball", soft_ball},
                                                                         {"Stiff box", stiff_box},
                                                                         {"Rope", rope},
                                                                         {"Grains", grains}}};

/// The file's name without its ending, as a name of an object.
std::string name_of(const std::filesystem::path& file) {
  std::string name = file.stem().string().substr(0, 40);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
  return name.empty() ? "mesh" : name;
}

template <class Description>
NewObject from_file(Description description, const std::filesystem::path& file, const TriangleMesh& mesh) {
  const BoundingBox box = bounding_box(mesh.positions);
  description.name = name_of(file);
  description.mesh.source = FileMesh{std::filesystem::absolute(file).string()};
  fit_thickness(description.material, box.diagonal());
  return {std::move(description), box.center(), box.diagonal() / 2};
}

}  // namespace

Ball ball_for(float distance, float gravity) {
  Ball ball;
  ball.radius = distance / 40;
  ball.mass = 500.0f * 4 / 3 * static_cast<float>(pi) * ball.radius * ball.radius * ball.radius;
  // Falls by distance / 5 = g t^2 / 2 in t = distance / speed; at least one distance in half a second.
  ball.speed = std::max(std::sqrt(2.5f * gravity * distance), 2 * distance);
  return ball;
}

Vec3f aim(const Vec3f& from, const Vec3f& target, float speed, const Vec3f& gravity) {
  // from + v t + gravity t^2 / 2 = target  and  |v| = speed:  t = |target - from - gravity t^2 / 2| / speed
  const Vec3f straight = target - from;
  Vec3f way = straight;
  for (int i = 0; i < 100; ++i) {
    const float t = length(way) / speed;
    const Vec3f next = straight - gravity * (t * t / 2);
    if (length(next - way) < 1e-4f * length(straight)) return normalized(next);
    if (length(next) > 4 * length(straight)) break;
    way = next;
  }
  return normalized(straight);
}

AnyObjectDescription thrown(const Ball& ball, const Vec3f& from, const Vec3f& direction) {
  constexpr int subdivisions = 2;
  auto body = stiff("ball", 2 * static_cast<double>(ball.radius));
  body.mesh.source = TetBallMesh{subdivisions, 2, static_cast<double>(ball.radius)};
  const TriangleMesh surface = sphere(subdivisions, static_cast<double>(ball.radius));
  body.material.density =
      ball.mass / static_cast<float>(enclosed_volume(surface.positions, surface.triangles));
  body.material.restitution = 0.3f;
  body.color = warm;
  body.transform.translate = Vec3d(from);
  body.velocity = direction * ball.speed;
  return body;
}

const char* label(Addition addition) {
  return addition_kinds.at(static_cast<std::size_t>(addition)).label;
}

NewObject described(Addition addition, double size) {
  return addition_kinds.at(static_cast<std::size_t>(addition)).described(size);
}

namespace {

bool has_inside(const TriangleMesh& mesh) {
  try {
    return !closed_surface(mesh, "mesh").mesh.triangles.empty();
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

NewObject described(const std::filesystem::path& mesh_file) {
  const TriangleMesh mesh = read_triangle_mesh(mesh_file);
  if (has_inside(mesh)) {
    SoftBodyDescription body;
    static_cast<SoftBodyMaterial&>(body.material) = material::rubber;
    body.material.preset = "rubber";
    return from_file(std::move(body), mesh_file, mesh);
  }
  ClothDescription sheet;
  static_cast<ClothMaterial&>(sheet.material) = material::cotton;
  sheet.material.preset = "cotton";
  return from_file(std::move(sheet), mesh_file, mesh);
}

AnyObjectDescription placed_above(const Vec3f& point, const World& world, const NewObject& object) {
  constexpr int attempts = 40;
  const double free = 1.05 * object.radius;
  Vec3d center = Vec3d(point) + Vec3d{0, free, 0};
  for (int i = 0; i < attempts; ++i) {
    const Hit nearest = world.closest_point(Vec3f(center));
    // The point below is as near as intended, but for rounding.
    if (!nearest.found || nearest.distance >= 0.999 * free) break;
    center.y += free - 0.9 * nearest.distance;
  }
  AnyObjectDescription description = object.description;
  common(description).transform.translate = center - object.center;
  return description;
}

}  // namespace souple::viewer
