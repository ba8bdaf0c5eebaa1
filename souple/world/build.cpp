#include "souple/world/build.h"

#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/rest_frames.h"
#include "souple/objects/constraint_sets.h"
#include "souple/objects/object.h"
#include "souple/world/add.h"
#include "souple/world/sleeping.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace souple {
namespace {

/// Adds constraints of the kinds that are wanted to the sets of one object.
class Builder {
 public:
  Builder(const SetKinds& wanted, ConstraintSets& sets) : wanted_(wanted), sets_(sets) {}

  bool wants(SetKind kind) const { return wanted_.has(kind); }
  bool wants_any(const SetKinds& kinds) const { return (wanted_ & kinds).any(); }
  template <class Kind>
  SetProjector<Kind>& set() {
    return std::get<SetProjector<Kind>>(sets_.sets);
  }
  /// Slivers of an imported surface have no shape that floats could distinguish from a line: they are skipped and
  /// counted.
  template <class Function>
  void add_if_valid(const Function& add) {
    try {
      add();
    } catch (const Error&) {
      ++sets_.skipped;
    }
  }

 private:
  SetKinds wanted_;
  ConstraintSets& sets_;
};

double rest_area(const Object& object, const Triangle& t) {
  return 0.5 * length(cross(object.rest[t[1]] - object.rest[t[0]], object.rest[t[2]] - object.rest[t[0]]));
}

/// A factor or stiffness of 0 makes no constraint: its compliance would be infinite.
bool usable(float compliance) {
  return std::isfinite(compliance);
}

// Edge springs of a sheet with membrane stiffness Y [N/m]: k = Y (A0 + A1) / l^2, where A0 and A1 are the
// areas of the edge's triangles. Under an equal stretch eps in all directions every triangle then stores Y
// eps^2 3/4 A, the energy of a sheet with Poisson's ratio 1/3. On equilateral triangles (k = sqrt(3)/2 Y) it
// is exact for every strain.
void add_springs(const Object& object, const ClothMaterial& m, Builder& to) {
  const TriangleEdges edges = triangle_edges(object.surface);
  std::vector<double> area(edges.edges.size());
  for (std::size_t t = 0; t < object.surface.size(); ++t)
    for (const std::uint32_t edge : edges.of_triangle[t])
      if (edge != TriangleEdges::no_edge) area[edge] += rest_area(object, object.surface[t]);
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    const Edge& edge = edges.edges[e];
    const double l = length(object.rest[edge[0]] - object.rest[edge[1]]);
    const double k = static_cast<double>(m.membrane_stiffness * object.mean(object.stiffness_map, edge)) *
                     area[e] / (l * l);
    const auto compliance = static_cast<float>(1 / k);
    if (usable(compliance))
      to.set<Distance>().add(edge, {static_cast<float>(l)}, {compliance}, m.damping_time, m.pbd_stretch);
  }
}

void add_membrane(const Object& object, const ClothMaterial& m, Builder& to) {
  const auto warp = static_cast<double>(m.membrane_stiffness);
  const double weft = m.weft_stiffness > 0 ? static_cast<double>(m.weft_stiffness) : warp;
  const auto poisson = static_cast<double>(m.poisson_ratio);
  const double shear =
      m.shear_stiffness > 0 ? static_cast<double>(m.shear_stiffness) : warp / (2 * (1 + poisson));
  if (!(warp > 0)) return;
  const std::vector<RestFrame> frames = rest_frames(object.mesh);
  for (std::size_t t = 0; t < object.surface.size(); ++t) {
    const Triangle& triangle = object.surface[t];
    const double area = rest_area(object, triangle);
    const auto scale = static_cast<double>(object.mean(object.stiffness_map, triangle));
    if (!(scale > 0) || !(area > 0)) continue;
    const Vec3d x[3] = {object.rest[triangle[0]], object.rest[triangle[1]], object.rest[triangle[2]]};
    to.add_if_valid([&] {
      to.set<TriangleMembrane>().add(
          triangle,
          TriangleMembrane::from_rest(
              x, frames[object.surface_source.empty() ? t : object.surface_source[t]].warp),
          TriangleMembrane::compliance(warp * scale, weft * scale, poisson, shear * scale, area),
          m.damping_time, m.pbd_stretch);
    });
  }
}

template <class Kind>
void add_hinges(const Object& object, const ClothMaterial& m, Builder& to) {
  for (const Hinge& hinge : interior_edges(object.surface)) {
    const float stiffness = m.bending_stiffness * object.mean(object.stiffness_map, hinge);
    if (!(stiffness > 0)) continue;
    const Vec3d x[4] = {object.rest[hinge[0]], object.rest[hinge[1]], object.rest[hinge[2]],
                        object.rest[hinge[3]]};
    to.add_if_valid([&] {
      to.set<Kind>().add(hinge, Kind::from_rest(x), Kind::compliance(static_cast<double>(stiffness)),
                         m.damping_time, m.pbd_bending);
    });
  }
}

// A spring between the vertices opposite an interior edge e. If two flat triangles of heights H2 and H3 over
// e bend by theta, these vertices approach: d^2 changes by -2 H2 H3 (1 - cos theta), so
//   C = d - d0 = -H2 H3 / (2 d0) theta^2 + O(theta^4),   H_i = 2 A_i / |e|.
// The lowest order of its energy 1/2 k C^2 is theta^4. That of a hinge, 1/2 D |e|^2 / (A2 + A3) theta^2, is
// theta^2, so no k makes the energies equal for small angles. The two terms are made equal at theta = 1 (57
// degrees):
//   k = D |e|^2 / (A2 + A3) (2 d0 / (H2 H3))^2
// Two equilateral triangles of side l have H = sqrt(3)/2 l, d0 = 2 H and k = 128 / (3 sqrt(3)) D / l^2. Below
// one radian the sheet is softer than D, above it stiffer. For a rest shape that is not flat, the spring
// keeps the rest distance and is stiffer at small angles.
void add_cross_springs(const Object& object, const ClothMaterial& m, Builder& to) {
  for (const Hinge& hinge : interior_edges(object.surface)) {
    const double D = static_cast<double>(m.bending_stiffness * object.mean(object.stiffness_map, hinge));
    if (!(D > 0)) continue;
    const Vec3d x[4] = {object.rest[hinge[0]], object.rest[hinge[1]], object.rest[hinge[2]],
                        object.rest[hinge[3]]};
    const double e = length(x[1] - x[0]), d0 = length(x[3] - x[2]);
    to.add_if_valid([&] {
      const auto scale = static_cast<double>(DihedralBending::from_rest(x).scale);  // |e| / sqrt(A2 + A3)
      const double height2 = length(cross(x[1] - x[0], x[2] - x[0])) / e;
      const double height3 = length(cross(x[1] - x[0], x[3] - x[0])) / e;
      const double slope = scale * 2 * d0 / (height2 * height3);
      const auto compliance = static_cast<float>(1 / (D * slope * slope));
      if (usable(compliance))
        to.set<Distance>().add(Edge{hinge[2], hinge[3]}, {static_cast<float>(d0)}, {compliance},
                               m.damping_time, m.pbd_bending);
    });
  }
}

void add_gas(const Object& object, ConstraintGroups& groups) {
  if (object.pressure == 0 && !object.enclosed_volume) return;
  std::vector<Triangle> triangles;
  for (const Triangle& t : object.surface)
    triangles.push_back({object.begin + t[0], object.begin + t[1], object.begin + t[2]});
  EnclosedVolumeOptions options{.pressure = object.pressure};
  if (object.enclosed_volume) {
    options.keep_volume = true;
    options.volume_factor = object.enclosed_volume->first;
    options.compliance = object.enclosed_volume->second;
  }
  groups.enclosed_volume.add(triangles, enclosed_volume(object.rest, object.surface), options);
}

SetKinds kinds_of_stretch(const ClothMaterial& m) {
  return m.stretch == StretchModel::springs ? SetKind::distance : SetKind::membrane;
}

SetKinds kinds_of_bending(const ClothMaterial& m) {
  switch (m.bending) {
    case BendingModel::isometric:
      return SetKind::isometric;
    case BendingModel::dihedral:
      return SetKind::dihedral;
    case BendingModel::distance:
      return SetKind::distance;
    case BendingModel::none:
      break;
  }
  return {};
}

SetKinds changed_kinds(const ClothMaterial& a, const ClothMaterial& b) {
  const auto stretch = [](const ClothMaterial& m) {
    return std::tuple(m.stretch, m.membrane_stiffness, m.weft_stiffness, m.shear_stiffness, m.poisson_ratio,
                      m.damping_time, m.pbd_stretch);
  };
  const auto bending = [](const ClothMaterial& m) {
    return std::tuple(m.bending, m.bending_stiffness, m.damping_time, m.pbd_bending);
  };
  SetKinds changed;
  if (stretch(a) != stretch(b)) changed |= kinds_of_stretch(a) | kinds_of_stretch(b);
  if (bending(a) != bending(b)) changed |= kinds_of_bending(a) | kinds_of_bending(b);
  return changed;
}

void add_elements(const Object& object, const ClothMaterial& m, Builder& to) {
  if (m.stretch == StretchModel::springs && to.wants(SetKind::distance)) add_springs(object, m, to);
  if (m.stretch == StretchModel::membrane && to.wants(SetKind::membrane)) add_membrane(object, m, to);
  if (!to.wants_any(kinds_of_bending(m))) return;
  if (m.bending == BendingModel::isometric) add_hinges<IsometricBending>(object, m, to);
  if (m.bending == BendingModel::dihedral) add_hinges<DihedralBending>(object, m, to);
  if (m.bending == BendingModel::distance) add_cross_springs(object, m, to);
}

void add_groups(const Object& object, const ClothMaterial&, ConstraintGroups& groups) {
  add_gas(object, groups);
}

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

void add_neo_hookean(const Object& object, const SoftBodyMaterial& m, Builder& to) {
  for (const Tet& tet : object.tets.tets) {
    const RestTet rest = rest_tet(object, tet);
    const auto E = static_cast<double>(m.young_modulus * object.mean(object.stiffness_map, tet));
    if (!(E > 0)) continue;
    to.set<NeoHookean>().add(tet, NeoHookean::from_rest(rest.x),
                             NeoHookean::compliance(E, static_cast<double>(m.poisson_ratio), rest.volume),
                             m.damping_time, m.pbd_stiffness);
  }
}

// Distribution of the tets' stiffness to their edges, like that of a cloth's triangles: each tet adds k = E V
// / l^2 to each of its six edges. The tets keep their volume with the bulk modulus.
void add_tet_springs(const Object& object, const SoftBodyMaterial& m, Builder& to) {
  const double bulk =
      static_cast<double>(m.young_modulus) / (3 * (1 - 2 * static_cast<double>(m.poisson_ratio)));
  std::map<Edge, double> stiffness;
  for (const Tet& tet : object.tets.tets) {
    const RestTet rest = rest_tet(object, tet);
    const auto scale = static_cast<double>(object.mean(object.stiffness_map, tet));
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

SetKinds changed_kinds(const SoftBodyMaterial& a, const SoftBodyMaterial& b) {
  const auto elastic = [](const SoftBodyMaterial& m) {
    return std::tuple(m.model, m.young_modulus, m.poisson_ratio, m.damping_time, m.pbd_stiffness);
  };
  return elastic(a) != elastic(b) ? kinds_of(a) | kinds_of(b) : SetKinds();
}

void add_elements(const Object& object, const SoftBodyMaterial& m, Builder& to) {
  if (!to.wants_any(kinds_of(m))) return;
  if (m.model == SoftBodyModel::neo_hookean) add_neo_hookean(object, m, to);
  if (m.model == SoftBodyModel::springs) add_tet_springs(object, m, to);
}

void add_groups(const Object& object, const SoftBodyMaterial& m, ConstraintGroups& groups) {
  if (m.model == SoftBodyModel::shape_matching) add_region(object, m, groups);
}

// Segments have the stretch stiffness k = E pi r^2 / l and the bending stiffness E I (see rope_bending.h).
void add_elements(const Object& object, const RopeMaterial& m, Builder& to) {
  const auto radius = static_cast<double>(m.radius);
  const auto E = static_cast<double>(m.young_modulus);
  for (std::uint32_t i = 0; i + 1 < object.particle_count(); ++i) {
    const Edge edge{i, i + 1};
    const double l = length(object.rest[i] - object.rest[i + 1]);
    const double k =
        E * pi * radius * radius / l * static_cast<double>(object.mean(object.stiffness_map, edge));
    const auto compliance = static_cast<float>(1 / k);
    if (usable(compliance) && to.wants(SetKind::distance))
      to.set<Distance>().add(edge, {static_cast<float>(l)}, {compliance}, m.damping_time, m.pbd_stretch);
    if (i + 2 >= object.particle_count() || !to.wants(SetKind::rope_bending)) continue;
    const std::array<std::uint32_t, 3> three{i, i + 1, i + 2};
    const auto bend = static_cast<float>(
        l * l * l / static_cast<double>(m.bending_stiffness * object.mean(object.stiffness_map, three)));
    if (usable(bend))
      to.set<RopeBending>().add(three, {static_cast<float>(l)}, {bend}, m.damping_time, m.pbd_bending);
  }
}

SetKinds changed_kinds(const RopeMaterial& a, const RopeMaterial& b) {
  const auto stretch = [](const RopeMaterial& m) {
    return std::tuple(m.radius, m.young_modulus, m.damping_time, m.pbd_stretch);
  };
  const auto bending = [](const RopeMaterial& m) {
    return std::tuple(m.bending_stiffness, m.damping_time, m.pbd_bending);
  };
  SetKinds changed;
  if (stretch(a) != stretch(b)) changed |= SetKind::distance;
  if (bending(a) != bending(b)) changed |= SetKind::rope_bending;
  return changed;
}

// Grains have contacts only, obstacles a prescribed motion; fluids have one solver for all (fluids.h).
template <class M>
void add_elements(const Object&, const M&, Builder&) {}
template <class M>
void add_groups(const Object&, const M&, ConstraintGroups&) {}
template <class M>
SetKinds changed_kinds(const M&, const M&) {
  return {};
}

void add_groups(const Object& object, ConstraintGroups& groups) {
  std::visit([&](const auto& material) { add_groups(object, material, groups); }, object.material);
}

bool is_one_region(const Material& material) {
  const auto* const soft = std::get_if<SoftBodyMaterial>(&material);
  return soft && soft->model == SoftBodyModel::shape_matching;
}

/// Whether contacts are the same with both materials.
bool same_contacts(const Material& a, const Material& b) {
  const auto law = [](const Material& material) {
    return std::visit(
        [](const auto& m) {
          std::tuple result(m.friction, m.restitution, std::optional<float>(), 0.0f);
          if constexpr (requires { m.kinetic_friction; }) std::get<2>(result) = m.kinetic_friction;
          if constexpr (requires { m.rolling_friction; }) std::get<3>(result) = m.rolling_friction;
          return result;
        },
        material);
  };
  return law(a) == law(b) && contact_radius(a) == contact_radius(b);
}

void find_element_radii(const Object& object, std::span<float> radius) {
  const auto include = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto R = static_cast<float>(enclosing_radius(object.rest[a], object.rest[b], object.rest[c]));
    for (const std::uint32_t i : {a, b, c}) radius[object.begin + i] = std::max(radius[object.begin + i], R);
  };
  for (const Triangle& t : object.surface) include(t[0], t[1], t[2]);
  for (std::uint32_t i = 0; object.kind == ObjectKind::rope && i + 1 < object.particle_count(); ++i)
    include(i, i + 1, i + 1);
}

}  // namespace

std::size_t build_elements(Object& object, const SetKinds& kinds) {
  const SetKinds wanted = object.fresh_kinds | kinds;
  auto fresh = std::make_unique<ConstraintSets>();
  Builder builder(wanted, *fresh);
  try {
    std::visit([&](const auto& material) { add_elements(object, material, builder); }, object.material);
    ConstraintGroups groups;  // whether they can be built
    add_groups(object, groups);
  } catch (const Error& error) {
    throw Error(object.name + ": " + error.what());
  }
  object.fresh = std::move(fresh);
  object.fresh_kinds = wanted;
  return object.fresh->skipped;
}

void replace_material(WorldState& world, Object& object, const Material& material) {
  const Material before = std::exchange(object.material, material);
  const SetKinds changed = std::visit(
      [&](const auto& m) { return changed_kinds(std::get<std::decay_t<decltype(m)>>(before), m); }, material);
  const bool groups_change = is_one_region(before) || is_one_region(material);
  try {
    if (changed.any() || groups_change) build_elements(object, changed);
  } catch (const Error&) {
    object.material = before;
    throw;
  }
  wake_island(world, object);
  const float density_ratio = density(material) / density(before);
  if (density_ratio != 1) scale_mass(world, object, density_ratio);
  world.dirty.constraints = world.dirty.constraints || changed.any();
  world.dirty.groups = world.dirty.groups || groups_change;
  world.dirty.radii = world.dirty.radii || contact_radius(material) != contact_radius(before);
  // Fluids read the materials and masses of all objects when tables are built.
  const bool with_fluids = std::any_of(world.objects.begin(), world.objects.end(),
                                       [](const auto& o) { return o->kind == ObjectKind::fluid; });
  world.dirty.tables = world.dirty.tables || with_fluids || !same_contacts(before, material);
}

namespace {

/// The objects' places in the sets: where they were when their constraints were last merged, and are now.
std::vector<ObjectPart> parts_of(const WorldState& world) {
  std::vector<ObjectPart> parts;
  for (const auto& object : world.objects)
    parts.push_back({object->merged_begin, object->merged_end, object->begin});
  return parts;
}

/// Merges what is new of one kind. Returns whether constraints came, went or were renumbered.
template <class Kind>
bool merge(WorldState& world, SetKind kind, std::span<const ObjectPart> parts, SetProjector<Kind>& of_all) {
  std::vector<SetProjector<Kind>*> fresh(world.objects.size());
  bool any_fresh = false;
  for (std::size_t o = 0; o < fresh.size(); ++o) {
    Object& object = *world.objects[o];
    if (!object.fresh_kinds.has(kind)) continue;
    fresh[o] = &std::get<SetProjector<Kind>>(object.fresh->sets);
    any_fresh = any_fresh || fresh[o]->size() > 0;
  }
  const bool any = any_fresh || of_all.size() > 0;
  if (!any || !(world.dirty.objects || std::any_of(fresh.begin(), fresh.end(), [](auto* f) { return f; })))
    return false;
  return !of_all.merge(parts, fresh);
}

void build_groups(WorldState& world) {
  ConstraintGroups& groups = world.constraints.of_objects->of_objects;
  groups = {};
  for (const auto& object : world.objects) add_groups(*object, groups);
  world.dirty.groups = false;
}

}  // namespace

bool build_constraints(WorldState& world) {
  if (!world.constraints.of_objects) world.constraints.of_objects = std::make_unique<ObjectConstraints>();
  ObjectConstraints& all = *world.constraints.of_objects;
  const std::vector<ObjectPart> parts = parts_of(world);
  bool changed = world.dirty.objects;
  std::size_t kind = 0;
  const auto merge_one = [&](auto& set) {
    changed |= merge(world, static_cast<SetKind>(kind++), parts, set);
  };
  std::apply([&](auto&... sets) { (merge_one(sets), ...); }, all.of_elements.sets);
  for (const auto& object : world.objects) {
    object->fresh.reset();
    object->fresh_kinds = {};
    object->merged_begin = object->begin, object->merged_end = object->reserved_end();
  }
  if (world.dirty.groups || world.dirty.objects) build_groups(world);
  world.constraints.object_projectors.clear();
  const auto list = [&](Projector& projector) {
    if (projector.size() > 0) world.constraints.object_projectors.push_back(&projector);
  };
  std::apply([&](auto&... sets) { (list(sets), ...); }, all.of_elements.sets);
  list(all.of_objects.shape_matching), list(all.of_objects.enclosed_volume);
  return changed;
}

void build_contact_radii(WorldState& world) {
  for (const auto& object : world.objects) {
    const float radius = contact_radius(object->material);
    for (std::uint32_t i = object->begin; i < object->end; ++i) {
      const std::uint32_t local = i - object->begin;
      const float scale = object->thickness_map.empty() ? 1 : object->thickness_map[local];
      const float offset = object->embedding_offset.empty() ? 0 : object->embedding_offset[local];
      world.particles.radius[i] = radius * scale - offset;
      world.particles.element_radius[i] = 0;
    }
    find_element_radii(*object, world.particles.element_radius);
  }
}

}  // namespace souple
