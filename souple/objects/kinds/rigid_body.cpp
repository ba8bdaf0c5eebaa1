#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/convex_hull.h"
#include "souple/geometry/mass_properties.h"
#include "souple/objects/checks.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"
#include "souple/objects/rigid_definition.h"

#include <optional>
#include <utility>

#include <fmt/core.h>

// Rigid bodies: the particles are points of the surface, which the body moves, and which cloth, ropes, grains and fluids
// push. Rigid bodies collide with each other and with colliders as convex shapes.

namespace souple {
namespace {

// Hulls of more vertices cost more than their detail is worth.
constexpr std::size_t most_hull_vertices = 64;

void check_change(const RigidBodyMaterial& from, const RigidBodyMaterial& to, std::string_view owner) {
  if (from.density != to.density)
    throw Error(fmt::format(
        "{}: density is {} kg/m^3 and cannot change to {}: a rigid body keeps its mass; add it again", owner,
        from.density, to.density));
}

void require_rigid_options(const ObjectOptions& options, const std::string& name) {
  const auto refuse = [&](const char* option) {
    throw Error(name + ": the option " + option + " does not apply to a rigid body, which does not deform");
  };
  if (!options.stiffness_map.empty()) refuse("stiffness_map");
  if (options.self_collision != SelfCollision::off) refuse("self_collision");
}

/// The hulls of the connected pieces of a surface, in the world. Leaves out flat pieces, which have none.
std::vector<ConvexHull> hulls_of(const Object& object, std::vector<std::string>& sentences) {
  const Components pieces = connected_components(object.surface, object.rest.size());
  std::vector<std::vector<Vec3d>> points(pieces.count);
  for (std::uint32_t i = 0; i < object.rest.size(); ++i)
    points[pieces.of_vertex[i]].push_back(object.rest[i]);
  std::erase_if(points, [](const auto& piece) { return piece.size() < 2; });  // no triangle uses it
  if (points.empty()) throw Error(object.name + ": the mesh has no triangles, so it is no solid");
  const HullOptions options{.max_vertices = most_hull_vertices};
  if (points.size() == 1) return {convex_hull(points[0], options, object.name)};
  std::vector<ConvexHull> hulls;
  for (const std::vector<Vec3d>& piece : points)
    if (auto hull = solid_convex_hull(piece, options, object.name)) hulls.push_back(std::move(*hull));
  const std::size_t flat = points.size() - hulls.size();
  if (hulls.empty())
    throw Error(
        fmt::format("{}: each of the {} pieces of its mesh is flat, so they enclose no volume; join "
                    "them, or give them a thickness",
                    object.name, flat));
  if (flat > 0)
    sentences.push_back(fmt::format("{} of its {} pieces {} flat, and do not collide with rigid bodies", flat,
                                    points.size(), flat == 1 ? "is" : "are"));
  return hulls;
}

MassProperties mass_of(const Object& object, const std::vector<ConvexHull>& hulls, double density,
                       std::vector<std::string>& sentences) {
  try {
    const ClosedSurface closed = closed_surface(object.mesh, object.name);
    const MassProperties solid = mass_properties(closed.mesh, density, object.name);
    for (std::string& sentence : closed.sentences()) sentences.push_back(std::move(sentence));
    return solid;
  } catch (const Error&) {
    sentences.push_back("its surface is not closed, so its mass is that of its convex hull");
  }
  std::vector<MassProperties> parts;
  parts.reserve(hulls.size());
  for (const ConvexHull& hull : hulls)
    parts.push_back(mass_properties(surface_mesh(hull), density, object.name));
  return combined(parts);
}

/// The ball that a finely divided mesh stands for, in the world: all points are on its surface, and the solid fills it. A
/// hull of few vertices would sink in and rock.
std::optional<Sphere> ball_of(const Object& object, const std::vector<ConvexHull>& hulls, double volume) {
  constexpr double roundness = 1e-3, filled = 0.97;
  if (hulls.size() != 1 || !(hulls[0].excess > 0)) return {};
  Vec3d lo = object.rest[0], hi = lo;
  for (const Vec3d& x : object.rest)
    for (int k = 0; k < 3; ++k) lo[k] = min(lo[k], x[k]), hi[k] = max(hi[k], x[k]);
  const Vec3d center = (lo + hi) * 0.5;
  const double radius = length(object.rest[0] - center);
  for (const Vec3d& x : object.rest)
    if (std::abs(length(x - center) - radius) > roundness * radius) return {};
  if (volume < filled * sphere_mass_properties(radius, 1).volume) return {};
  return Sphere{Vec3f(center), static_cast<float>(radius)};
}

/// The shapes by which a mesh collides, in its body's frame.
std::vector<ConvexShape> shapes_of(const Object& object, const std::vector<ConvexHull>& hulls, double volume,
                                   const BodyPose& pose, std::vector<std::string>& sentences) {
  const BodyPose world{pose.local_point({}), conjugate(pose.rotation)};
  if (const auto ball = ball_of(object, hulls, volume)) return {moved(*convex_shape_of(*ball), world)};
  std::vector<ConvexShape> shapes;
  double excess = 0;
  for (const ConvexHull& hull : hulls) {
    shapes.push_back(moved(convex_polyhedron(hull), world));
    excess = std::max(excess, hull.excess);
  }
  if (excess > 0)
    sentences.push_back(
        fmt::format("it collides as {} of at most {} vertices, up to {:.2g} m inside its surface",
                    hulls.size() == 1 ? "a convex hull" : "convex hulls", most_hull_vertices, excess));
  return shapes;
}

/// The solid with what is given of its mass. `placement`: of the frame in which that is given.
MassProperties with_given(MassProperties solid, const GivenMass& given, const Transform& placement,
                          const std::string& name) {
  if (given.mass) {
    check_all(name, {{"mass", *given.mass, range::positive, range::finite}});
    solid = with_mass(solid, *given.mass);
  }
  if (given.center) {
    require_within(name, "the center of mass", *given.center, range::coordinate);
    solid.center = placement.point(*given.center);
  }
  if (given.inertia) {
    require_inertia(*given.inertia, name + ": inertia");
    const Mat3d R = rotation_matrix(placement.rotation);
    solid.inertia = R * *given.inertia * transpose(R);
  }
  return solid;
}

/// The body of a solid, without a shape.
RigidDefinition body_of(const MassProperties& solid) {
  const PrincipalFrame frame = principal_frame(solid.inertia);
  RigidDefinition body;
  body.mass = solid.mass, body.inertia = frame.moments;
  body.pose = {solid.center, frame.rotation};
  return body;
}

/// Gives particles their places in the body and their part of its mass.
void finish_body(NewObject& made, RigidDefinition body, const ObjectOptions& options) {
  Object& object = *made.object;
  for (const Vec3d& x : object.rest) body.particles.push_back(body.pose.local_point(x));
  made.mass.assign(object.rest.size(), body.mass / static_cast<double>(object.rest.size()));
  made.rigid = std::make_unique<RigidDefinition>(std::move(body));
  finish_object(made, options);
}

// --- analytic shapes

/// The shape, scaled.
Shape scaled(const Shape& shape, double scale, const std::string& name) {
  const auto s = static_cast<float>(scale);
  Shape result = shape;
  if (auto* const ball = std::get_if<Sphere>(&result)) {
    ball->center *= s, ball->radius *= s;
  } else if (auto* const box = std::get_if<Box>(&result)) {
    box->center *= s, box->half_extents *= s;
  } else if (auto* const capsule = std::get_if<Capsule>(&result)) {
    capsule->center *= s, capsule->radius *= s, capsule->half_height *= s;
  } else if (auto* const cylinder = std::get_if<Cylinder>(&result)) {
    cylinder->center *= s, cylinder->radius *= s, cylinder->half_height *= s;
  } else {
    throw Error(
        fmt::format("{}: a {} is no shape of a rigid body; use a sphere, box, capsule, cylinder or mesh",
                    name, shape_name(shape)));
  }
  return result;
}

struct Analytic {
  TriangleMesh mesh;  // of the surface, for drawing and for contacts with particles
  MassProperties solid;
  Vec3d center{};
};

Analytic analytic(const Shape& shape, double density) {
  if (const auto* const ball = std::get_if<Sphere>(&shape)) {
    const auto r = static_cast<double>(ball->radius);
    return {sphere(3, r), sphere_mass_properties(r, density), Vec3d(ball->center)};
  }
  if (const auto* const block = std::get_if<Box>(&shape)) {
    const Vec3d size = Vec3d(block->half_extents) * 2.0;
    return {box(size), box_mass_properties(size, density), Vec3d(block->center)};
  }
  if (const auto* const pill = std::get_if<Capsule>(&shape)) {
    const auto r = static_cast<double>(pill->radius), l = 2 * static_cast<double>(pill->half_height);
    if (!(l > 0)) return analytic(Sphere{pill->center, pill->radius}, density);
    return {capsule(r, l, 24, 6), capsule_mass_properties(r, l, density), Vec3d(pill->center)};
  }
  const auto& drum = std::get<Cylinder>(shape);
  const auto r = static_cast<double>(drum.radius), height = 2 * static_cast<double>(drum.half_height);
  return {cylinder(r, height, 32), cylinder_mass_properties(r, height, density), Vec3d(drum.center)};
}

}  // namespace

NewObject import_rigid_body(std::string name, const TriangleMesh& mesh, const RigidBodyMaterial& material,
                            const ObjectOptions& options) {
  NewObject made = start_object(std::move(name), material, options);
  require_rigid_options(options, made.object->name);
  import_surface(made, mesh, options.transform);
  const Object& object = *made.object;
  const std::vector<ConvexHull> hulls = hulls_of(object, made.sentences);
  const MassProperties solid = mass_of(object, hulls, static_cast<double>(material.density), made.sentences);
  RigidDefinition body = body_of(with_given(solid, options.given_mass, options.transform, object.name));
  body.shape.parts = shapes_of(object, hulls, solid.volume, body.pose, made.sentences);
  finish_body(made, std::move(body), options);
  return made;
}

NewObject import_rigid_body(std::string name, const Shape& shape, const RigidBodyMaterial& material,
                            const ObjectOptions& options) {
  NewObject made = start_object(std::move(name), material, options);
  const std::string& owner = made.object->name;
  require_rigid_options(options, owner);
  validate(shape, owner);
  const Shape sized = scaled(shape, options.transform.scale, owner);
  Analytic solid = analytic(sized, static_cast<double>(material.density));
  const Transform placement{options.transform.point(Vec3d{}), options.transform.rotation, 1};
  Transform centered = placement;
  centered.translation = placement.point(solid.center);
  import_surface(made, solid.mesh, centered);
  RigidDefinition body =
      body_of(with_given(moved(solid.solid, centered), options.given_mass, options.transform, owner));
  // In the body's frame: the shape's frame, seen from the body's.
  const BodyPose frame{body.pose.local_point(placement.translation),
                       conjugate(body.pose.rotation) * placement.rotation};
  body.shape.parts.push_back(moved(*convex_shape_of(sized), frame));
  finish_body(made, std::move(body), options);
  return made;
}

namespace {

void append(TriangleMesh& mesh, const TriangleMesh& part, const Transform& placement) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& x : part.positions) mesh.positions.push_back(placement.point(x));
  for (const Triangle& t : part.triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace

NewObject import_rigid_body(std::string name, std::span<const RigidPart> parts,
                            const RigidBodyMaterial& material, const ObjectOptions& options) {
  NewObject made = start_object(std::move(name), material, options);
  const std::string& owner = made.object->name;
  require_rigid_options(options, owner);
  if (parts.empty()) throw Error(owner + ": there are no shapes; a rigid body needs at least one");
  TriangleMesh mesh;
  std::vector<MassProperties> solids;
  std::vector<std::pair<Shape, Transform>> placed;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::string part = fmt::format("{}, shape {}", owner, k);
    validate(parts[k].shape, part);
    validate(parts[k].pose, part);
    if (parts[k].pose.scale != 1)
      throw Error(
          fmt::format("{}: the scale is {}, expected 1: scale the whole body", part, parts[k].pose.scale));
    const double density = parts[k].density.value_or(static_cast<double>(material.density));
    check_all(part, {{"density", density, range::positive, range::finite}});
    const Shape sized = scaled(parts[k].shape, options.transform.scale, part);
    const Analytic solid = analytic(sized, density);
    const Transform placement{options.transform.point(parts[k].pose.translation),
                              normalized(options.transform.rotation * parts[k].pose.rotation), 1};
    Transform centered = placement;
    centered.translation = placement.point(solid.center);
    append(mesh, solid.mesh, centered);
    solids.push_back(moved(solid.solid, centered));
    placed.emplace_back(sized, placement);
  }
  import_surface(made, mesh, Transform{});
  RigidDefinition body = body_of(with_given(combined(solids), options.given_mass, options.transform, owner));
  for (const auto& [shape, placement] : placed)
    body.shape.parts.push_back(moved(
        *convex_shape_of(shape),
        {body.pose.local_point(placement.translation), conjugate(body.pose.rotation) * placement.rotation}));
  finish_body(made, std::move(body), options);
  return made;
}

constinit const KindFunctions kinds::rigid_body{
    .traits = {.name = "rigid_body", .shape = ObjectShape::surface, .rigid = true},
    .default_material = default_material<RigidBodyMaterial>,
    .validate = of_material<check_fields<RigidBodyMaterial>>,
    .validate_change = of_two_materials<check_change>,
    .density = of_material<volumetric_density<RigidBodyMaterial>>,
    .contact_radius = of_material<half_thickness<RigidBodyMaterial>>,
    .contact_material = of_material<contact_material<RigidBodyMaterial>>,
};

}  // namespace souple
