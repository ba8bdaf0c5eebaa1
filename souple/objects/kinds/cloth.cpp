#include "souple/assert.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/rest_frames.h"
#include "souple/objects/checks.h"
#include "souple/objects/constraint_builder.h"
#include "souple/objects/constraint_groups.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"

#include <algorithm>
#include <tuple>
#include <utility>

// Cloth: a thin sheet of triangles.

namespace souple {
namespace {

float areal_density(const ClothMaterial& m) {
  return m.areal_density;
}

double rest_area(const Object& object, const Triangle& t) {
  return 0.5 * length(cross(object.rest[t[1]] - object.rest[t[0]], object.rest[t[2]] - object.rest[t[0]]));
}

// Edge springs of a sheet with membrane stiffness Y [N/m]: k = Y (A0 + A1) / l^2, where A0 and A1 are the
// areas of the edge's triangles. Under an equal stretch eps in all directions every triangle then stores Y
// eps^2 3/4 A, the energy of a sheet with Poisson's ratio 1/3. On equilateral triangles (k = sqrt(3)/2 Y) it
// is exact for every strain.
void add_springs(const Object& object, const ClothMaterial& m, ConstraintBuilder& to) {
  const TriangleEdges edges = triangle_edges(object.surface);
  std::vector<double> area(edges.edges.size());
  for (std::size_t t = 0; t < object.surface.size(); ++t)
    for (const std::uint32_t edge : edges.of_triangle[t])
      if (edge != TriangleEdges::no_edge) area[edge] += rest_area(object, object.surface[t]);
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    const Edge& edge = edges.edges[e];
    const double l = length(object.rest[edge[0]] - object.rest[edge[1]]);
    const double k =
        static_cast<double>(m.membrane_stiffness * object.mean(object.per_particle.stiffness, edge)) *
        area[e] / (l * l);
    const auto compliance = static_cast<float>(1 / k);
    if (usable(compliance))
      to.set<Distance>().add(edge, {static_cast<float>(l)}, {compliance}, m.damping_time, m.pbd_stretch);
  }
}

void add_membrane(const Object& object, const ClothMaterial& m, ConstraintBuilder& to) {
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
    const auto scale = static_cast<double>(object.mean(object.per_particle.stiffness, triangle));
    if (!(scale > 0) || !(area > 0)) continue;
    const Vec3d x[3] = {object.rest[triangle[0]], object.rest[triangle[1]], object.rest[triangle[2]]};
    to.add_if_valid([&] {
      to.set<TriangleMembrane>().add(
          triangle,
          TriangleMembrane::from_rest(
              x, frames[object.triangle_source.empty() ? t : object.triangle_source[t]].warp),
          TriangleMembrane::compliance(warp * scale, weft * scale, poisson, shear * scale, area),
          m.damping_time, m.pbd_stretch);
    });
  }
}

template <class Kind>
void add_hinges(const Object& object, const ClothMaterial& m, ConstraintBuilder& to) {
  for (const Hinge& hinge : interior_edges(object.surface)) {
    const float stiffness = m.bending_stiffness * object.mean(object.per_particle.stiffness, hinge);
    if (!(stiffness > 0)) continue;
    const Vec3d x[4] = {object.rest[hinge[0]], object.rest[hinge[1]], object.rest[hinge[2]],
                        object.rest[hinge[3]]};
    to.add_if_valid([&] {
      to.set<Kind>().add(hinge, Kind::from_rest(x), Kind::compliance(static_cast<double>(stiffness)),
                         m.damping_time, m.pbd_bending);
    });
  }
}

// A spring between the vertices opposite an interior edge e. Let two flat triangles of heights H2 and H3 over e bend by
// theta. Then d^2 between these vertices changes by -2 H2 H3 (1 - cos theta), so
//   C = d - d0 = -H2 H3 / (2 d0) theta^2 + O(theta^4),   H_i = 2 A_i / |e|.
// The lowest order of its energy 1/2 k C^2 is theta^4. That of a hinge, 1/2 D |e|^2 / (A2 + A3) theta^2, is
// theta^2, so no k makes the energies equal for small angles. The two terms are made equal at theta = 1 (57
// degrees):
//   k = D |e|^2 / (A2 + A3) (2 d0 / (H2 H3))^2
// Two equilateral triangles of side l have H = sqrt(3)/2 l, d0 = 2 H and k = 128 / (3 sqrt(3)) D / l^2. Below
// one radian the sheet is softer than D, above it stiffer. For a rest shape that is not flat, the spring
// keeps the rest distance and is stiffer at small angles.
void add_cross_springs(const Object& object, const ClothMaterial& m, ConstraintBuilder& to) {
  for (const Hinge& hinge : interior_edges(object.surface)) {
    const double D =
        static_cast<double>(m.bending_stiffness * object.mean(object.per_particle.stiffness, hinge));
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

void add_gas(const ClothMaterial&, const Object& object, ConstraintGroups& groups) {
  if (object.gas.pressure == 0 && !object.gas.volume) return;
  // The surface is repaired already, so its vertices keep their numbers, and centers of holes follow.
  TriangleMesh surface;
  surface.positions = object.rest, surface.triangles = object.surface;
  std::vector<EnclosedVolume::Mean> means;
  if (!find_holes(surface.positions, surface.triangles).empty()) {
    ClosedSurface closed = closed_surface(surface, object.name);
    for (Hole& hole : closed.holes) {
      for (std::uint32_t& i : hole.loop) i += object.begin;
      means.push_back({object.end + static_cast<std::uint32_t>(means.size()), std::move(hole.loop)});
    }
    surface = std::move(closed.mesh);
    SOUPLE_ASSERT(surface.positions.size() == object.rest.size() + means.size(), "a repaired surface");
  }
  const double volume = enclosed_volume(surface.positions, surface.triangles);
  for (Triangle& t : surface.triangles)
    for (std::uint32_t& i : t) i += object.begin;
  EnclosedVolumeOptions options{.pressure = object.gas.pressure};
  if (object.gas.volume) {
    options.keep_volume = true;
    options.volume_factor = object.gas.volume->first;
    options.compliance = object.gas.volume->second;
  }
  groups.enclosed_volume.add(surface.triangles, volume, options, means);
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

SetKinds changed_cloth_kinds(const ClothMaterial& a, const ClothMaterial& b) {
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

void add_cloth_elements(const ClothMaterial& m, const Object& object, ConstraintBuilder& to) {
  if (m.stretch == StretchModel::springs && to.wants(SetKind::distance)) add_springs(object, m, to);
  if (m.stretch == StretchModel::membrane && to.wants(SetKind::membrane)) add_membrane(object, m, to);
  if (!to.wants_any(kinds_of_bending(m))) return;
  if (m.bending == BendingModel::isometric) add_hinges<IsometricBending>(object, m, to);
  if (m.bending == BendingModel::dihedral) add_hinges<DihedralBending>(object, m, to);
  if (m.bending == BendingModel::distance) add_cross_springs(object, m, to);
}

}  // namespace

NewObject import_cloth(std::string name, const TriangleMesh& mesh, const ClothMaterial& material,
                       const ObjectOptions& options) {
  NewObject cloth = start_object(std::move(name), material, options);
  Object& object = *cloth.object;
  import_surface(cloth, mesh, options.transform);
  cloth.mass = lumped_masses(object.rest, object.surface, static_cast<double>(material.areal_density));
  fill_missing_masses(cloth.mass, object.name);
  finish_object(cloth, options);
  return cloth;
}

constinit const KindFunctions kinds::cloth{
    .traits = {.name = "cloth", .shape = ObjectShape::surface},
    .default_material = default_material<ClothMaterial>,
    .find_preset = preset<material::find_cloth>,
    .validate = of_material<check_fields<ClothMaterial>>,
    .density = of_material<areal_density>,
    .add_elements = of_material<add_cloth_elements>,
    .add_groups = of_material<add_gas>,
    .changed_kinds = of_two_materials<changed_cloth_kinds>,
    .contact_radius = of_material<half_thickness<ClothMaterial>>,
    .contact_material = of_material<contact_material<ClothMaterial>>,
};

}  // namespace souple
