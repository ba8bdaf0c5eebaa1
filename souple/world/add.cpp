#include "souple/world/add.h"

#include "souple/assert.h"
#include "souple/fluid/emitter_record.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/embedding.h"
#include "souple/geometry/fill.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/mesh_report.h"
#include "souple/geometry/polyline.h"
#include "souple/geometry/reorder.h"
#include "souple/geometry/weld.h"
#include "souple/objects/embedding_offset.h"
#include "souple/objects/object.h"
#include "souple/world/build.h"
#include "souple/world/caches.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/obstacles.h"
#include "souple/world/user_constraint.h"
#include "souple/world/validate.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr std::uint32_t max_fluid_particles = 50'000'000;  // particles

/// An object under construction: an Object without particles yet, and the masses of its future particles.
struct ObjectBuilder {
  std::unique_ptr<Object> object = std::make_unique<Object>();
  std::vector<double> mass;  ///< per particle [kg]
};

ObjectBuilder make_builder(const WorldState& world, ObjectKind kind, const Material& material,
                           const ObjectOptions& options) {
  world.require_between_steps("adding an object");
  ObjectBuilder result;
  result.object->kind = kind;
  result.object->name = world.unique_name(options.name, kind_name(kind));
  if (kind != ObjectKind::fluid && options.max_particles > 0)
    throw Error(fmt::format("{}: max_particles is {}: only fluids gain particles; leave it 0",
                            result.object->name, options.max_particles));
  if (options.max_particles > max_fluid_particles)
    throw Error(fmt::format("{}: max_particles is {}, expected at most {}", result.object->name,
                            options.max_particles, max_fluid_particles));
  result.object->material = material;
  std::visit([&](const auto& m) { validate(m, result.object->name); }, material);
  validate(options.transform, result.object->name);
  if (!is_finite(options.velocity) || !is_finite(options.angular_velocity))
    throw Error(result.object->name + ": the velocity is not finite");
  return result;
}

void transform_points(std::vector<Vec3d>& points, const Transform& transform, const std::string& name) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = transform.point(points[i]);
    // A float holds up to 3e38, but squared lengths must fit as well.
    if (!is_finite(points[i]) || length(points[i]) > 1e15)
      throw Error(fmt::format("{}: vertex {} is not finite, or more than 1e15 m from the origin", name, i));
  }
}

/// Moves a mesh to its place: positions and the normals of its file.
void place(TriangleMesh& mesh, const Transform& transform, const std::string& name) {
  transform_points(mesh.positions, transform, name);
  for (Vec3f& normal : mesh.appearance.normals) normal = Vec3f(rotate(transform.rotation, Vec3d(normal)));
}

std::vector<float> gather_map(const std::vector<float>& map, const Object& object, std::size_t vertices,
                              const char* what) {
  if (map.empty()) return {};
  if (map.size() != vertices)
    throw Error(
        fmt::format("{}: the {} map has {} values for {} vertices", object.name, what, map.size(), vertices));
  std::vector<float> per_particle;
  for (const std::uint32_t vertex : object.vertex_of) {
    if (!(map[vertex] >= 0) || !std::isfinite(map[vertex]))
      throw Error(fmt::format("{}: the {} map is {} at vertex {}, expected a finite number >= 0", object.name,
                              what, map[vertex], vertex));
    per_particle.push_back(map[vertex]);
  }
  return per_particle;
}

void set_motion(WorldState& world, const Object& object, const ObjectOptions& options) {
  if (object.particle_count() == 0) return;
  Vec3d center;
  double mass = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const auto m = static_cast<double>(world.particles.mass[i]);
    center += object.rest[i - object.begin] * m;
    mass += m;
  }
  center = center / mass;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const Vec3d r = object.rest[i - object.begin] - center;
    world.particles.velocity[i].set_xyz(
        Vec3f(Vec3d(options.velocity) + cross(Vec3d(options.angular_velocity), r)));
    if (object.kind == ObjectKind::grains) world.particles.spin[i].set_xyz(options.angular_velocity);
  }
}

/// Frees the spare capacity of arrays that grew item by item, except the capacity for emitters: an object's
/// shape is final.
void shrink(Object& object) {
  const auto shrink_all = [](auto&... vectors) { (vectors.shrink_to_fit(), ...); };
  shrink_all(object.mesh.positions, object.mesh.triangles, object.mesh.uvs, object.mesh.colors,
             object.mesh.faces, object.mesh.face_uvs, object.tets.positions, object.tets.tets, object.rest,
             object.particle_of, object.vertex_of, object.surface, object.surface_source,
             object.stiffness_map, object.thickness_map, object.embedding_offset);
  for (auto* map : {&object.particle_of, &object.vertex_of}) map->reserve(object.capacity);
  object.rest.reserve(object.capacity);
}

/// Creates the object's particles and adds it to the world. If an earlier call threw, the world is unchanged.
ObjectId register_object(WorldState& world, ObjectBuilder builder, const ObjectOptions& options) {
  Object& object = *builder.object;
  object.capacity = std::max(static_cast<std::uint32_t>(object.rest.size()), options.max_particles);
  if (object.capacity == 0) throw Error(object.name + ": there are no vertices");
  object.stiffness_map = gather_map(options.stiffness_map, object, object.vertex_count(), "stiffness");
  object.thickness_map = gather_map(options.thickness_map, object, object.vertex_count(), "thickness");
  const std::size_t skipped = build_elements(object, SetKinds::all());
  if (skipped > 0)
    world.warnings.log_info(
        object.name, {fmt::format("{} elements are too thin for a bending or membrane constraint", skipped)});
  object.self_collision = options.self_collision;
  require_layer(object, options.layer);
  object.layer = options.layer;
  object.filter = {options.collision_groups, options.collision_mask};
  shrink(object);
  object.id = {world.next_id++};
  Particles& particles = world.particles;
  object.begin = static_cast<std::uint32_t>(particles.size());
  object.end = object.begin + static_cast<std::uint32_t>(object.rest.size());
  particles.resize(object.reserved_end());
  if (object.kind == ObjectKind::grains && !particles.has_spin()) particles.add_spin();
  world.object_of.resize(object.reserved_end(), static_cast<std::uint32_t>(world.objects.size()));
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const double mass = builder.mass[i - object.begin];
    particles.mass[i] = static_cast<float>(mass);
    particles.position[i].w = mass > 0 ? static_cast<float>(1 / mass) : 0.0f;
    world.teleport_particle(i, object.rest[i - object.begin]);
  }
  if (object.kind != ObjectKind::obstacle) set_motion(world, object, options);
  world.dirty.all();
  world.contact->invalidate();
  ++world.version;
  SOUPLE_ASSERT(world.object_of.size() == particles.size(), "every particle belongs to an object");
  world.names.add(object.name, {NameRegistry::Owner::object, object.id.value});
  world.object_index.add(builder.object->id.value);
  world.objects.push_back(std::move(builder.object));
  return world.objects.back()->id;
}

/// Imports particles in the order of a space-filling curve; sets particle_of and vertex_of accordingly.
void import_particles(Object& object, std::vector<Vec3d> rest, const std::vector<std::uint32_t>& to_particle,
                      const std::vector<std::uint32_t>& to_vertex) {
  const std::vector<std::uint32_t> order = morton_order(rest);  // order[new] = old
  std::vector<std::uint32_t> new_of(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) new_of[order[i]] = i;
  for (const std::uint32_t old : order) {
    object.rest.push_back(rest[old]);
    object.vertex_of.push_back(to_vertex[old]);
  }
  for (const std::uint32_t old : to_particle) object.particle_of.push_back(new_of[old]);
  SOUPLE_ASSERT(object.vertex_of.size() == object.rest.size(), "one vertex per particle");
}

std::vector<std::uint32_t> identity(std::size_t count) {
  std::vector<std::uint32_t> result(count);
  std::iota(result.begin(), result.end(), 0u);
  return result;
}

/// Vertices without elements have no mass. They get the smallest mass of the other vertices, so that they
/// fall and collide like specks.
void fill_missing_masses(std::vector<double>& mass, const std::string& name) {
  if (mass.empty()) throw Error(name + ": there are no vertices");
  double smallest = 0;
  for (const double m : mass)
    if (m > 0 && (smallest == 0 || m < smallest)) smallest = m;
  if (!(smallest > 0)) throw Error(name + ": its elements have no area or volume, so it has no mass");
  for (double& m : mass)
    if (!(m > 0)) m = smallest;
}

}  // namespace

float density(const Material& material) {
  struct Density {
    float operator()(const ClothMaterial& m) const { return m.areal_density; }
    float operator()(const SoftBodyMaterial& m) const { return m.density; }
    float operator()(const RopeMaterial& m) const { return m.density; }
    float operator()(const GrainsMaterial& m) const { return m.density; }
    float operator()(const FluidMaterial& m) const { return m.density; }
    float operator()(const ObstacleMaterial&) const { return 1; }  // no mass to scale
  };
  return std::visit(Density{}, material);
}

float contact_radius(const Material& material) {
  struct Radius {
    float operator()(const ClothMaterial& m) const { return m.thickness / 2; }
    float operator()(const SoftBodyMaterial& m) const { return m.thickness / 2; }
    float operator()(const RopeMaterial& m) const { return m.radius; }
    float operator()(const GrainsMaterial& m) const { return m.radius; }
    // The density solver keeps particles half a spacing from walls; contacts only catch the rest.
    float operator()(const FluidMaterial& m) const { return m.spacing / 4; }
    float operator()(const ObstacleMaterial& m) const { return m.thickness / 2; }
  };
  return std::visit(Radius{}, material);
}

void scale_mass(WorldState& world, const Object& object, float factor) {
  world.dirty.masses = true;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    world.particles.mass[i] *= factor;
    if (world.particles.position[i].w > 0) world.particles.position[i].w = 1 / world.particles.mass[i];
  }
}

void require_permanent_particles(const Object& object, const char* what) {
  if (object.kind == ObjectKind::fluid)
    throw Error(
        std::string(what) + ": " + object.name +
        " is a fluid, whose particles come and go; contain it with walls, or push it with a force field");
}

void require_layer(const Object& object, int layer) {
  constexpr int max_layer = 1000;
  if (layer < 0 || layer > max_layer)
    throw Error(
        fmt::format("{}: layer is {}, expected a whole number from 0 to {}", object.name, layer, max_layer));
  if (layer != 0 && object.surface.empty())
    throw Error(object.name +
                ": layer: only an object with its own surface can have a layer (cloth, a soft body "
                "made of tets, an obstacle); leave it 0");
}

void require_movable(const Object& object, const char* what) {
  if (object.kind == ObjectKind::obstacle)
    throw Error(std::string(what) + ": " + object.name +
                " is an obstacle, which only its motion moves; use set_motion");
}

void remove_object(WorldState& world, const Object& object) {
  const std::uint32_t begin = object.begin, end = object.reserved_end();
  const std::size_t index = world.object_of[begin];
  world.particles.erase(begin, end);
  world.object_of.erase(world.object_of.begin() + begin, world.object_of.begin() + end);
  for (std::uint32_t& i : world.object_of)
    if (i > index) --i;
  for (const auto& other : world.objects)
    if (other->begin >= end) other->begin -= end - begin, other->end -= end - begin;
  for (UserConstraint& user_constraint : world.constraints.users) user_constraint.erase_particles(begin, end);
  world.contact->contacts.erase_particles(begin, end);
  world.caches->mirrors.erase(object.id.value);
  std::erase_if(world.flow.emitters,
                [&](const EmitterRecord& record) { return record.fluid == object.id.value; });
  world.names.remove(world.objects[index]->name);
  world.object_index.remove(object.id.value);
  world.objects.erase(world.objects.begin() + static_cast<std::ptrdiff_t>(index));
  world.dirty.all();
  world.contact->invalidate();
  ++world.version;
}

namespace {

/// Imports the welded vertices of a surface as particles, and its valid triangles over them.
void import_surface(const WorldState& world, Object& object, const TriangleMesh& mesh,
                    const Transform& transform) {
  check_indices(mesh, object.name.c_str());
  object.mesh = mesh;
  place(object.mesh, transform, object.name);
  const RepairedSurface repaired = repair(object.mesh);
  world.warnings.log_info(object.name, repaired.sentences);
  const Weld& weld = repaired.weld;
  import_particles(object, gather<Vec3d>(weld, object.mesh.positions), weld.to_welded, weld.to_vertex);
  if (repaired.source != identity(object.mesh.triangles.size())) object.surface_source = repaired.source;
  for (const Triangle& triangle : repaired.triangles)
    object.surface.push_back({object.particle_of[weld.to_vertex[triangle[0]]],
                              object.particle_of[weld.to_vertex[triangle[1]]],
                              object.particle_of[weld.to_vertex[triangle[2]]]});
}

/// Imports the nodes of a tet mesh as particles, and its tets over them.
void import_tets(Object& object, const TetMesh& mesh) {
  import_particles(object, mesh.positions, identity(mesh.positions.size()), identity(mesh.positions.size()));
  object.tets.positions = object.rest;
  for (Tet tet : mesh.tets) {
    for (std::uint32_t& i : tet) i = object.particle_of[i];
    object.tets.tets.push_back(tet);
  }
}

void require_volumes(const TetMesh& mesh, const std::string& name) {
  if (mesh.tets.empty()) throw Error(name + ": there are no tets; for a surface, use a lattice");
  const std::vector<double> volumes = tet_volumes(mesh);
  for (std::size_t t = 0; t < volumes.size(); ++t)
    if (!(volumes[t] > 0))
      throw Error(
          fmt::format("{}: tet {} is {}; expected a positive volume, vertices (a, b, c, d) with "
                      "(b - a) x (c - a) . (d - a) > 0",
                      name, t, volumes[t] < 0 ? "inside out" : "flat"));
}

/// vertex_of for embedded objects: the nearest of the vertices that a particle moves, or of its neighbors'
/// vertices.
void name_nearest_vertices(Object& object) {
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<double> nearest(object.rest.size(), never);
  object.vertex_of.assign(object.rest.size(), 0);
  for (std::uint32_t v = 0; v < object.mesh.positions.size(); ++v)
    for (const std::uint32_t i : object.embedding->vertices[v]) {
      const double distance = length(object.rest[i] - object.mesh.positions[v]);
      if (distance < nearest[i]) nearest[i] = distance, object.vertex_of[i] = v;
    }
  for (std::size_t pass = 0; pass < 64; ++pass) {
    bool changed = false;
    for (const Tet& tet : object.tets.tets)
      for (const std::uint32_t i : tet)
        for (const std::uint32_t j : tet)
          if (nearest[i] == never && nearest[j] < never) {
            object.vertex_of[i] = object.vertex_of[j];
            nearest[i] = length(object.rest[i] - object.mesh.positions[object.vertex_of[i]]);
            changed = true;
          }
    if (!changed) break;
  }
}

}  // namespace

ObjectId World::add_cloth(const TriangleMesh& mesh, const ClothMaterial& material,
                          const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder cloth = make_builder(world, ObjectKind::cloth, material, options);
  Object& object = *cloth.object;
  import_surface(world, object, mesh, options.transform);
  cloth.mass = lumped_masses(object.rest, object.surface, static_cast<double>(material.areal_density));
  fill_missing_masses(cloth.mass, object.name);
  return register_object(world, std::move(cloth), options);
}

ObjectId World::add_soft_body(const TetMesh& mesh, const SoftBodyMaterial& material,
                              const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder body = make_builder(world, ObjectKind::soft_body, material, options);
  Object& object = *body.object;
  check_indices(mesh, object.name.c_str());
  TetMesh placed = mesh;
  transform_points(placed.positions, options.transform, object.name);
  require_volumes(placed, object.name);
  import_tets(object, placed);
  object.mesh.positions = placed.positions;
  object.mesh.triangles = surface_triangles(placed.tets);
  object.mesh.groups = placed.groups;
  for (const Triangle& t : object.mesh.triangles)
    object.surface.push_back({object.particle_of[t[0]], object.particle_of[t[1]], object.particle_of[t[2]]});
  body.mass = lumped_masses(object.tets, static_cast<double>(material.density));
  fill_missing_masses(body.mass, object.name);
  return register_object(world, std::move(body), options);
}

ObjectId World::add_soft_body(const TriangleMesh& surface, const SoftBodyMaterial& material,
                              const LatticeOptions& options_of_lattice, const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder body = make_builder(world, ObjectKind::soft_body, material, options);
  Object& object = *body.object;
  check_indices(surface, object.name.c_str());
  object.mesh = surface;
  place(object.mesh, options.transform, object.name);
  LatticeOptions fineness = options_of_lattice;
  if (fineness.cells == 0 && fineness.cell_size == 0) fineness.cells = 2000;
  const Lattice lattice = build_lattice(object.mesh, fineness, object.name);
  world.warnings.log_info(object.name, lattice.sentences);

  import_tets(object, lattice.mesh);
  object.embedding = embed(object.mesh.positions, object.tets);
  name_nearest_vertices(object);
  // The lattice is larger than the surface, so its particles would reach the floor before the surface. Each
  // outer particle may therefore penetrate by its distance from the surface.
  object.embedding_offset = distances_outside(object.rest, object.mesh, 2 * lattice.cell_size);
  const double density =
      static_cast<double>(material.density) * lattice.surface_volume / lattice.lattice_volume;
  body.mass = lumped_masses(object.tets, density);
  fill_missing_masses(body.mass, object.name);
  return register_object(world, std::move(body), options);
}

ObjectId World::add_rope(std::span<const Vec3d> points, std::uint32_t segments, const RopeMaterial& material,
                         const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder rope = make_builder(world, ObjectKind::rope, material, options);
  Object& object = *rope.object;
  if (points.size() < 2)
    throw Error(fmt::format("{}: a rope needs at least two points, got {}", object.name, points.size()));
  if (segments < 1 || segments > 10000000)
    throw Error(fmt::format("{}: segments is {}, expected 1 to 10,000,000", object.name, segments));
  std::vector<Vec3d> path(points.begin(), points.end());
  transform_points(path, options.transform, object.name);
  object.rest = resample_polyline(path, segments);
  const double length_of_all = polyline_length(path);
  if (!(length_of_all > 0)) throw Error(object.name + ": its points coincide, so the rope has no length");
  object.particle_of = object.vertex_of = identity(object.rest.size());
  const auto radius = static_cast<double>(material.radius);
  const double mass = static_cast<double>(material.density) * pi * radius * radius * length_of_all / segments;
  rope.mass.assign(object.rest.size(), mass);
  rope.mass.front() = rope.mass.back() = mass / 2;
  return register_object(world, std::move(rope), options);
}

ObjectId World::add_grains(std::span<const Vec3d> centers, const GrainsMaterial& material,
                           const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder grains = make_builder(world, ObjectKind::grains, material, options);
  Object& object = *grains.object;
  object.rest.assign(centers.begin(), centers.end());
  transform_points(object.rest, options.transform, object.name);
  object.particle_of = object.vertex_of = identity(object.rest.size());
  const auto radius = static_cast<double>(material.radius);
  grains.mass.assign(object.rest.size(),
                     static_cast<double>(material.density) * 4 / 3 * pi * radius * radius * radius);
  return register_object(world, std::move(grains), options);
}

namespace {

/// The density solver supports a single spacing.
void require_same_spacing(const WorldState& world, const Object& fluid, float spacing) {
  for (const auto& other : world.objects) {
    const auto* material = std::get_if<FluidMaterial>(&other->material);
    if (material && other.get() != &fluid && material->spacing != spacing)
      throw Error(fmt::format(
          "{}: spacing is {} m, but that of {} is {} m: all fluids of a world must have the same spacing",
          fluid.name, spacing, other->name, material->spacing));
  }
}

void require_fluid_options(const ObjectOptions& options, const std::string& name) {
  const auto refuse = [&](const char* option) {
    throw Error(name + ": the option " + option + " does not apply to a fluid");
  };
  if (!options.stiffness_map.empty()) refuse("stiffness_map");
  if (!options.thickness_map.empty()) refuse("thickness_map");
  if (options.self_collision) refuse("self_collision");
}

}  // namespace

ObjectId World::add_fluid(std::span<const Vec3d> centers, const FluidMaterial& material,
                          const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder fluid = make_builder(world, ObjectKind::fluid, material, options);
  Object& object = *fluid.object;
  require_fluid_options(options, object.name);
  require_same_spacing(world, object, material.spacing);
  object.rest.assign(centers.begin(), centers.end());
  transform_points(object.rest, options.transform, object.name);
  object.particle_of = object.vertex_of = identity(object.rest.size());
  const auto d = static_cast<double>(material.spacing);
  fluid.mass.assign(object.rest.size(), static_cast<double>(material.density) * d * d * d);
  return register_object(world, std::move(fluid), options);
}

ObjectId World::add_fluid(const TriangleMesh& surface, const FluidMaterial& material,
                          const ObjectOptions& options) {
  const std::string name = options.name.empty() ? std::string(kind_name(ObjectKind::fluid)) : options.name;
  validate(material, name);
  TriangleMesh placed = surface;
  transform_points(placed.positions, options.transform, name);
  ObjectOptions transformed = options;
  transformed.transform = {};
  return add_fluid(fill(placed, static_cast<double>(material.spacing), name), material, transformed);
}

namespace {

void require_obstacle_options(const ObjectOptions& options, const std::string& name) {
  const auto refuse = [&](const char* option) {
    throw Error(name + ": the option " + option +
                " does not apply to an obstacle, which only its motion moves");
  };
  if (length_squared(options.velocity) > 0) refuse("velocity");
  if (length_squared(options.angular_velocity) > 0) refuse("angular_velocity");
  if (!options.stiffness_map.empty()) refuse("stiffness_map");
  if (options.self_collision) refuse("self_collision");
}

}  // namespace

ObjectId World::add_obstacle(const TriangleMesh& mesh, const ObstacleMaterial& material,
                             ObstacleMotion motion, const ObjectOptions& options) {
  WorldState& world = impl_->state;
  ObjectBuilder obstacle = make_builder(world, ObjectKind::obstacle, material, options);
  Object& object = *obstacle.object;
  require_obstacle_options(options, object.name);
  import_surface(world, object, mesh, options.transform);
  if (object.surface.empty()) throw Error(object.name + ": the mesh has no triangles to collide with");
  validate(motion, object.vertex_count(), object.name);
  object.motion = std::move(motion);
  object.placement = options.transform;
  obstacle.mass.assign(object.rest.size(), 0.0);
  const std::vector<Vec3d> now = obstacle_positions(object, world.time);
  const ObjectId id = register_object(world, std::move(obstacle), options);
  const std::uint32_t begin = world.object(id).begin;
  for (std::uint32_t k = 0; k < now.size(); ++k) world.teleport_particle(begin + k, now[k]);
  return id;
}

}  // namespace souple
