#include "souple/world/build.h"

#include "souple/constraints/dihedral_bending.h"
#include "souple/constraints/distance.h"
#include "souple/constraints/isometric_bending.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/rope_bending.h"
#include "souple/constraints/tet_volume.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/rest_frames.h"
#include "souple/solver/enclosed_volume.h"
#include "souple/solver/shape_matching.h"
#include "souple/world/add.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

/// One projector of each kind, filled object by object.
struct Kinds {
  std::unique_ptr<SetProjector<Distance>> distance = std::make_unique<SetProjector<Distance>>();
  std::unique_ptr<SetProjector<TriangleMembrane>> membrane =
      std::make_unique<SetProjector<TriangleMembrane>>();
  std::unique_ptr<SetProjector<IsometricBending>> isometric =
      std::make_unique<SetProjector<IsometricBending>>();
  std::unique_ptr<SetProjector<DihedralBending>> dihedral = std::make_unique<SetProjector<DihedralBending>>();
  std::unique_ptr<SetProjector<RopeBending>> rope_bending = std::make_unique<SetProjector<RopeBending>>();
  std::unique_ptr<SetProjector<NeoHookean>> neo_hookean = std::make_unique<SetProjector<NeoHookean>>();
  std::unique_ptr<SetProjector<TetVolume>> tet_volume = std::make_unique<SetProjector<TetVolume>>();
  std::unique_ptr<ShapeMatching> shape_matching = std::make_unique<ShapeMatching>();
  std::unique_ptr<EnclosedVolume> enclosed_volume = std::make_unique<EnclosedVolume>();
  std::size_t skipped = 0;  ///< elements of cloths that are too thin
};

double rest_area(const Object& object, const Triangle& t) {
  return 0.5 * length(cross(object.rest[t[1]] - object.rest[t[0]], object.rest[t[2]] - object.rest[t[0]]));
}

/// Slivers of an imported surface have no shape that floats could distinguish from a line: they are skipped
/// and counted.
template <class Function>
void add_if_valid(Kinds& kinds, const Function& add) {
  try {
    add();
  } catch (const Error&) {
    ++kinds.skipped;
  }
}

/// Adds `begin` to every index.
template <std::size_t n>
std::array<std::uint32_t, n> shifted(std::array<std::uint32_t, n> indices, std::uint32_t begin) {
  for (std::uint32_t& i : indices) i += begin;
  return indices;
}

/// A factor or stiffness of 0 makes no constraint: its compliance would be infinite.
bool usable(float compliance) {
  return std::isfinite(compliance);
}

// Edge springs of a sheet with membrane stiffness Y [N/m]: k = Y (A0 + A1) / l^2, where A0 and A1 are the
// areas of the edge's triangles. Under an equal stretch eps in all directions every triangle then stores Y
// eps^2 3/4 A, the energy of a sheet with Poisson's ratio 1/3. On equilateral triangles (k = sqrt(3)/2 Y) it
// is exact for every strain.
void add_springs(const Object& object, const ClothMaterial& m, Kinds& kinds) {
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
      kinds.distance->add(shifted(edge, object.begin), {static_cast<float>(l)}, {compliance}, m.damping_time,
                          m.pbd_stretch);
  }
}

void add_membrane(const Object& object, const ClothMaterial& m, Kinds& kinds) {
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
    add_if_valid(kinds, [&] {
      kinds.membrane->add(
          shifted(triangle, object.begin),
          TriangleMembrane::from_rest(
              x, frames[object.surface_source.empty() ? t : object.surface_source[t]].warp),
          TriangleMembrane::compliance(warp * scale, weft * scale, poisson, shear * scale, area),
          m.damping_time, m.pbd_stretch);
    });
  }
}

template <class Kind>
void add_hinges(const Object& object, const ClothMaterial& m, SetProjector<Kind>& set, Kinds& kinds) {
  for (const Hinge& hinge : interior_edges(object.surface)) {
    const float stiffness = m.bending_stiffness * object.mean(object.stiffness_map, hinge);
    if (!(stiffness > 0)) continue;
    const Vec3d x[4] = {object.rest[hinge[0]], object.rest[hinge[1]], object.rest[hinge[2]],
                        object.rest[hinge[3]]};
    add_if_valid(kinds, [&] {
      set.add(shifted(hinge, object.begin), Kind::from_rest(x),
              Kind::compliance(static_cast<double>(stiffness)), m.damping_time, m.pbd_bending);
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
void add_cross_springs(const Object& object, const ClothMaterial& m, Kinds& kinds) {
  for (const Hinge& hinge : interior_edges(object.surface)) {
    const double D = static_cast<double>(m.bending_stiffness * object.mean(object.stiffness_map, hinge));
    if (!(D > 0)) continue;
    const Vec3d x[4] = {object.rest[hinge[0]], object.rest[hinge[1]], object.rest[hinge[2]],
                        object.rest[hinge[3]]};
    const double e = length(x[1] - x[0]), d0 = length(x[3] - x[2]);
    add_if_valid(kinds, [&] {
      const auto scale = static_cast<double>(DihedralBending::from_rest(x).scale);  // |e| / sqrt(A2 + A3)
      const double height2 = length(cross(x[1] - x[0], x[2] - x[0])) / e;
      const double height3 = length(cross(x[1] - x[0], x[3] - x[0])) / e;
      const double slope = scale * 2 * d0 / (height2 * height3);
      const auto compliance = static_cast<float>(1 / (D * slope * slope));
      if (usable(compliance))
        kinds.distance->add(shifted(Edge{hinge[2], hinge[3]}, object.begin), {static_cast<float>(d0)},
                            {compliance}, m.damping_time, m.pbd_bending);
    });
  }
}

void add_gas(const Object& object, Kinds& kinds) {
  if (object.pressure == 0 && !object.enclosed_volume) return;
  std::vector<Triangle> triangles;
  for (const Triangle& t : object.surface) triangles.push_back(shifted(t, object.begin));
  EnclosedVolumeOptions options{.pressure = object.pressure};
  if (object.enclosed_volume) {
    options.keep_volume = true;
    options.volume_factor = object.enclosed_volume->first;
    options.compliance = object.enclosed_volume->second;
  }
  kinds.enclosed_volume->add(triangles, enclosed_volume(object.rest, object.surface), options);
}

void add_object(const Object& object, const ClothMaterial& m, Kinds& kinds) {
  if (m.stretch == StretchModel::springs) add_springs(object, m, kinds);
  if (m.stretch == StretchModel::membrane) add_membrane(object, m, kinds);
  if (m.bending == BendingModel::isometric) add_hinges(object, m, *kinds.isometric, kinds);
  if (m.bending == BendingModel::dihedral) add_hinges(object, m, *kinds.dihedral, kinds);
  if (m.bending == BendingModel::distance) add_cross_springs(object, m, kinds);
  add_gas(object, kinds);
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

void add_neo_hookean(const Object& object, const SoftBodyMaterial& m, Kinds& kinds) {
  for (const Tet& tet : object.tets.tets) {
    const RestTet rest = rest_tet(object, tet);
    const auto E = static_cast<double>(m.young_modulus * object.mean(object.stiffness_map, tet));
    if (!(E > 0)) continue;
    kinds.neo_hookean->add(shifted(tet, object.begin), NeoHookean::from_rest(rest.x),
                           NeoHookean::compliance(E, static_cast<double>(m.poisson_ratio), rest.volume),
                           m.damping_time, m.pbd_stiffness);
  }
}

// Distribution of the tets' stiffness to their edges, like that of a cloth's triangles: each tet adds k = E V
// / l^2 to each of its six edges. The tets keep their volume with the bulk modulus.
void add_tet_springs(const Object& object, const SoftBodyMaterial& m, Kinds& kinds) {
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
    kinds.tet_volume->add(shifted(tet, object.begin), TetVolume::from_rest(rest.x),
                          TetVolume::compliance(bulk * scale, rest.volume), m.damping_time, m.pbd_stiffness);
  }
  for (const auto& [edge, k] : stiffness) {
    const double l = length(object.rest[edge[0]] - object.rest[edge[1]]);
    kinds.distance->add(shifted(edge, object.begin), {static_cast<float>(l)}, {static_cast<float>(1 / k)},
                        m.damping_time, m.pbd_stiffness);
  }
}

// One region. A uniform stretch e along an axis moves its particles by e q, q along that axis: C^2 = e^2 <q^2>. Its
// energy C^2 / (2 alpha) is the material's, E e^2 V / 2, with
//   alpha = <|q|^2> / (3 E V),   <>: mean over the mass, V: volume
//
// Its vibrations are no vibrations of a material, as all have the same frequency, 1 / sqrt(alpha M). They are damped
// nearly critically where only a face is in contact: a box on a slope would otherwise hop, and walk down.
void add_region(const Object& object, const SoftBodyMaterial& m, Kinds& kinds) {
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
  kinds.shape_matching->add(particles, object.rest,
                            {.compliance = static_cast<float>(1 / stiffness),
                             .damping_time = m.damping_time + static_cast<float>(own_damping * time),
                             .stiffness = m.pbd_stiffness});
}

void add_object(const Object& object, const SoftBodyMaterial& m, Kinds& kinds) {
  switch (m.model) {
    case SoftBodyModel::neo_hookean:
      add_neo_hookean(object, m, kinds);
      break;
    case SoftBodyModel::springs:
      add_tet_springs(object, m, kinds);
      break;
    case SoftBodyModel::shape_matching:
      add_region(object, m, kinds);
      break;
  }
}

// Segments have the stretch stiffness k = E pi r^2 / l and the bending stiffness E I (see rope_bending.h).
void add_object(const Object& object, const RopeMaterial& m, Kinds& kinds) {
  const auto radius = static_cast<double>(m.radius);
  const auto E = static_cast<double>(m.young_modulus);
  for (std::uint32_t i = 0; i + 1 < object.particle_count(); ++i) {
    const Edge edge{i, i + 1};
    const double l = length(object.rest[i] - object.rest[i + 1]);
    const double k =
        E * pi * radius * radius / l * static_cast<double>(object.mean(object.stiffness_map, edge));
    const auto compliance = static_cast<float>(1 / k);
    if (usable(compliance))
      kinds.distance->add(shifted(edge, object.begin), {static_cast<float>(l)}, {compliance}, m.damping_time,
                          m.pbd_stretch);
    if (i + 2 >= object.particle_count()) continue;
    const std::array<std::uint32_t, 3> three{i, i + 1, i + 2};
    const auto bend = static_cast<float>(
        l * l * l / static_cast<double>(m.bending_stiffness * object.mean(object.stiffness_map, three)));
    if (usable(bend))
      kinds.rope_bending->add(shifted(three, object.begin), {static_cast<float>(l)}, {bend}, m.damping_time,
                              m.pbd_bending);
  }
}

void add_object(const Object&, const GrainsMaterial&, Kinds&) {}    // contacts only
void add_object(const Object&, const FluidMaterial&, Kinds&) {}     // one solver for all, see fluids.h
void add_object(const Object&, const ObstacleMaterial&, Kinds&) {}  // prescribed motion

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

std::size_t check_constraints(const Object& object) {
  Kinds kinds;
  try {
    std::visit([&](const auto& material) { add_object(object, material, kinds); }, object.material);
  } catch (const Error& error) {
    throw Error(object.name + ": " + error.what());
  }
  return kinds.skipped;
}

void build_constraints(WorldState& world) {
  Kinds kinds;
  for (const auto& object : world.objects)
    std::visit([&](const auto& material) { add_object(*object, material, kinds); }, object->material);
  world.object_constraints.clear();
  const auto keep = [&](auto projector) {
    if (projector->size() > 0) world.object_constraints.push_back(std::move(projector));
  };
  keep(std::move(kinds.distance));
  keep(std::move(kinds.membrane));
  keep(std::move(kinds.isometric));
  keep(std::move(kinds.dihedral));
  keep(std::move(kinds.rope_bending));
  keep(std::move(kinds.neo_hookean));
  keep(std::move(kinds.tet_volume));
  keep(std::move(kinds.shape_matching));
  keep(std::move(kinds.enclosed_volume));
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
