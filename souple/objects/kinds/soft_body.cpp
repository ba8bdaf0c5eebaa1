#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/closest_point.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/objects/checks.h"
#include "souple/objects/constraint_builder.h"
#include "souple/objects/constraint_groups.h"
#include "souple/objects/contact_geometry.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/core.h>

// Soft bodies: tets, those of a tet mesh or of a lattice that a surface is embedded in.

namespace souple {
namespace {

struct RestTet {
  Vec3d x[4];
  double volume;
};

RestTet rest_tet(const Object& object, const Tet& tet) {
  RestTet result{{object.rest[tet[0]], object.rest[tet[1]], object.rest[tet[2]], object.rest[tet[3]]}, 0};
  const auto& x = result.x;
  result.volume = dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) / 6;
  return result;
}

void add_neo_hookean(const Object& object, const SoftBodyMaterial& m, ConstraintBuilder& to) {
  for (const Tet& tet : object.tets.tets) {
    const RestTet rest = rest_tet(object, tet);
    const auto E = static_cast<double>(m.young_modulus * object.mean(object.per_particle.stiffness, tet));
    if (!(E > 0)) continue;
    to.set<NeoHookean>().add(tet, NeoHookean::from_rest(rest.x),
                             NeoHookean::compliance(E, static_cast<double>(m.poisson_ratio), rest.volume),
                             m.damping_time, m.pbd_stiffness);
  }
}

// Distribution of the tets' stiffness to their edges, like that of a cloth's triangles: each tet adds k = E V
// / l^2 to each of its six edges. The tets keep their volume with the bulk modulus.
void add_tet_springs(const Object& object, const SoftBodyMaterial& m, ConstraintBuilder& to) {
  const double bulk =
      static_cast<double>(m.young_modulus) / (3 * (1 - 2 * static_cast<double>(m.poisson_ratio)));
  std::map<Edge, double> stiffness;
  for (const Tet& tet : object.tets.tets) {
    const RestTet rest = rest_tet(object, tet);
    const auto scale = static_cast<double>(object.mean(object.per_particle.stiffness, tet));
    if (!(scale > 0)) continue;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        stiffness[{std::min(tet[a], tet[b]), std::max(tet[a], tet[b])}] +=
            scale * static_cast<double>(m.young_modulus) * rest.volume /
            dot(rest.x[a] - rest.x[b], rest.x[a] - rest.x[b]);
    to.set<TetVolume>().add(tet, TetVolume::from_rest(rest.x),
                            TetVolume::compliance(bulk * scale, rest.volume), m.damping_time,
                            m.pbd_stiffness);
  }
  for (const auto& [edge, k] : stiffness) {
    const double l = length(object.rest[edge[0]] - object.rest[edge[1]]);
    to.set<Distance>().add(edge, {static_cast<float>(l)}, {static_cast<float>(1 / k)}, m.damping_time,
                           m.pbd_stiffness);
  }
}

// One region. A uniform stretch e along an axis moves its particles by e q, q along that axis: C^2 = e^2 <q^2>. Its
// energy C^2 / (2 alpha) is the material's, E e^2 V / 2, with
//   alpha = <|q|^2> / (3 E V),   <>: mean over the mass, V: volume
//
// Its vibrations are no vibrations of a material, as all have the same frequency, 1 / sqrt(alpha M). They are damped
// nearly critically where only a face is in contact: a box on a slope would otherwise hop, and walk down.
void add_region(const Object& object, const SoftBodyMaterial& m, ConstraintGroups& groups) {
  constexpr double own_damping = 4;  // times the period over 2 pi
  std::vector<std::uint32_t> particles;
  for (std::uint32_t i = 0; i < object.particle_count(); ++i) particles.push_back(object.begin + i);
  double volume = 0, square = 0;  // of a quarter of each tet at each of its corners
  Vec3d center{};
  const auto for_each_corner = [&](const auto& visit) {
    for (const Tet& tet : object.tets.tets) {
      const double quarter = rest_tet(object, tet).volume / 4;
      for (const std::uint32_t i : tet) visit(object.rest[i], quarter);
    }
  };
  for_each_corner([&](const Vec3d& q, double v) { volume += v, center += q * v; });
  center = center / volume;
  for_each_corner([&](const Vec3d& q, double v) { square += length_squared(q - center) * v; });
  const double stiffness = 3 * static_cast<double>(m.young_modulus) * volume * volume / square;
  const double time = std::sqrt(static_cast<double>(m.density) * volume / stiffness);
  groups.shape_matching.add(particles, object.rest,
                            {.compliance = static_cast<float>(1 / stiffness),
                             .damping_time = m.damping_time + static_cast<float>(own_damping * time),
                             .stiffness = m.pbd_stiffness});
}

SetKinds kinds_of(const SoftBodyMaterial& m) {
  switch (m.model) {
    case SoftBodyModel::neo_hookean:
      return SetKind::neo_hookean;
    case SoftBodyModel::springs:
      return SetKinds(SetKind::distance) | SetKind::tet_volume;
    case SoftBodyModel::shape_matching:
      break;
  }
  return {};
}

SetKinds changed_soft_body_kinds(const SoftBodyMaterial& a, const SoftBodyMaterial& b) {
  const auto elastic = [](const SoftBodyMaterial& m) {
    return std::tuple(m.model, m.young_modulus, m.poisson_ratio, m.damping_time, m.pbd_stiffness);
  };
  return elastic(a) != elastic(b) ? kinds_of(a) | kinds_of(b) : SetKinds();
}

void add_soft_body_elements(const SoftBodyMaterial& m, const Object& object, ConstraintBuilder& to) {
  if (!to.wants_any(kinds_of(m))) return;
  if (m.model == SoftBodyModel::neo_hookean) add_neo_hookean(object, m, to);
  if (m.model == SoftBodyModel::springs) add_tet_springs(object, m, to);
}

bool is_one_region(const SoftBodyMaterial& m) {
  return m.model == SoftBodyModel::shape_matching;
}

void add_groups(const SoftBodyMaterial& m, const Object& object, ConstraintGroups& groups) {
  if (is_one_region(m)) add_region(object, m, groups);
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

using Cell = std::array<long long, 3>;

Cell cell_of(const Vec3d& x, double size) {
  return {static_cast<long long>(std::floor(x.x / size)), static_cast<long long>(std::floor(x.y / size)),
          static_cast<long long>(std::floor(x.z / size))};
}

/// The nearest point of the surface so far: its distance, and the dot product with its normal (positive
/// outside).
struct Foot {
  double distance, side = 0;
};

/// Distance of each point outside a closed surface [m]; 0 inside and beyond `max_distance`.
std::vector<float> distances_outside(const std::vector<Vec3d>& points, const TriangleMesh& surface,
                                     double max_distance) {
  std::map<Cell, std::vector<std::size_t>> grid;
  for (std::size_t i = 0; i < points.size(); ++i) grid[cell_of(points[i], max_distance)].push_back(i);
  const std::vector<Vec3d> normals = vertex_normals(surface);
  std::vector<Foot> feet(points.size(), {max_distance});

  for (const Triangle& t : surface.triangles) {
    const Vec3d &a = surface.positions[t[0]], &b = surface.positions[t[1]], &c = surface.positions[t[2]];
    const BoundingBox box = bounding_box(std::vector<Vec3d>{a, b, c});
    const Vec3d margin{max_distance, max_distance, max_distance};
    const Cell lo = cell_of(box.lo - margin, max_distance), hi = cell_of(box.hi + margin, max_distance);
    for (long long x = lo[0]; x <= hi[0]; ++x)
      for (long long y = lo[1]; y <= hi[1]; ++y)
        for (auto cell = grid.lower_bound({x, y, lo[2]});
             cell != grid.end() && cell->first <= Cell{x, y, hi[2]}; ++cell)
          for (const std::size_t i : cell->second) {
            const TrianglePoint w = closest_on_triangle(points[i], a, b, c);
            const Vec3d away = points[i] - (a * w.a + b * w.b + c * w.c);
            const double distance = length(away);
            if (distance >= feet[i].distance) continue;
            // The normal blended from the vertices' normals classifies the side at edges and corners as well.
            feet[i] = {distance, dot(away, normals[t[0]] * w.a + normals[t[1]] * w.b + normals[t[2]] * w.c)};
          }
  }
  std::vector<float> result;
  result.reserve(feet.size());
  for (const Foot& foot : feet) result.push_back(foot.side > 0 ? static_cast<float>(foot.distance) : 0.0f);
  return result;
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

// Particles of soft bodies do not bounce alone, see world/body_restitution.h.
ContactMaterial bouncing_as_a_whole(const SoftBodyMaterial& m) {
  ContactMaterial result = kinds::contact_material(m);
  if (!(m.restitution > elastic_restitution)) result.restitution = 0;
  return result;
}

}  // namespace

NewObject import_soft_body(std::string name, const TetMesh& mesh, const SoftBodyMaterial& material,
                           const ObjectOptions& options) {
  NewObject body = start_object(std::move(name), material, options);
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
  finish_object(body, options);
  return body;
}

NewObject import_soft_body(std::string name, const TriangleMesh& surface, const SoftBodyMaterial& material,
                           const LatticeOptions& options_of_lattice, const ObjectOptions& options) {
  NewObject body = start_object(std::move(name), material, options);
  Object& object = *body.object;
  check_indices(surface, object.name.c_str());
  object.mesh = surface;
  place(object.mesh, options.transform, object.name);
  LatticeOptions fineness = options_of_lattice;
  if (fineness.cells == 0 && fineness.cell_size == 0) fineness.cells = 2000;
  const Lattice lattice = build_lattice(object.mesh, fineness, object.name);
  body.sentences = lattice.sentences;

  import_tets(object, lattice.mesh);
  object.embedding = embed(object.mesh.positions, object.tets);
  name_nearest_vertices(object);
  // The lattice is larger than the surface, so its particles would reach the floor before the surface. Each
  // outer particle may therefore penetrate by its distance from the surface.
  object.per_particle.outside = distances_outside(object.rest, object.mesh, 2 * lattice.cell_size);
  const double density =
      static_cast<double>(material.density) * lattice.surface_volume / lattice.lattice_volume;
  body.mass = lumped_masses(object.tets, density);
  fill_missing_masses(body.mass, object.name);
  finish_object(body, options);
  return body;
}

constinit const KindFunctions kinds::soft_body{
    .traits = {.name = "soft_body", .shape = ObjectShape::solid},
    .default_material = default_material<SoftBodyMaterial>,
    .find_preset = preset<material::find_soft_body>,
    .validate = of_material<check_fields<SoftBodyMaterial>>,
    .density = of_material<volumetric_density<SoftBodyMaterial>>,
    .add_elements = of_material<add_soft_body_elements>,
    .add_groups = of_material<add_groups>,
    .changed_kinds = of_two_materials<changed_soft_body_kinds>,
    .has_groups_of_material = of_material<is_one_region>,
    .contact_radius = of_material<half_thickness<SoftBodyMaterial>>,
    .contact_material = of_material<bouncing_as_a_whole>,
};

}  // namespace souple
