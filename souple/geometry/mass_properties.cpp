#include "souple/geometry/mass_properties.h"

#include "souple/error.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/mesh_report.h"
#include "souple/math/svd.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

void require_positive(const std::string& name, const char* what, double value, const char* expected) {
  if (std::isfinite(value) && value > 0) return;
  throw Error(fmt::format("{}: {} is {:g}, expected a positive {}", name, what, value, expected));
}

void require_density(const std::string& name, double density) {
  require_positive(name, "density", density, "density in kg/m^3, such as 1000 for water");
}

void require_size(const char* name, const char* what, double value) {
  require_positive(name, what, value, "length in meters");
}

// Requires a surface that is closed and consistently wound outward. Its volume must exceed rounding: a sheet folded
// onto itself encloses about epsilon times its area times its size.
void require_solid(const TriangleMesh& mesh, const MeshReport& report, const std::string& name) {
  require_closed(report, name);
  if (!report.inconsistent_edges.empty())
    throw Error(
        fmt::format("{}: {} edges join triangles of opposite winding (the first is between vertices {} and "
                    "{}), so the mesh has no "
                    "inside; wind all triangles counterclockwise seen from outside, or call repair first",
                    name, report.inconsistent_edges.size(), report.inconsistent_edges[0][0],
                    report.inconsistent_edges[0][1]));
  const double size = bounding_box(mesh.positions).diagonal();
  const double rounding = 1e-12 * size * surface_area(mesh.positions, mesh.triangles);
  if (report.signed_volume < -rounding)
    throw Error(fmt::format(
        "{}: the enclosed volume is {:g} m^3, because the triangles are wound inward; reverse them, "
        "or call repair first",
        name, report.signed_volume));
  if (!(report.signed_volume > rounding))
    throw Error(fmt::format("{}: the mesh is closed but encloses no volume ({:g} m^3); give it a thickness",
                            name, report.signed_volume));
}

// A triangle and a reference point span a tet. Its corners relative to the point are p, q, r and 0, and six times its
// signed volume is d = p . (q x r). The tets of all triangles of a closed surface sum to its inside.
struct ReferenceTet {
  Vec3d p, q, r;
  double d;

  ReferenceTet(const TriangleMesh& mesh, const Triangle& t, const Vec3d& reference)
      : p(mesh.positions[t[0]] - reference),
        q(mesh.positions[t[1]] - reference),
        r(mesh.positions[t[2]] - reference),
        d(dot(p, cross(q, r))) {}

  // integral of x = d / 24 (p + q + r)
  Vec3d first_moment() const { return (p + q + r) * (d / 24); }
  // integral of x x^T = d / 120 (p p^T + q q^T + r r^T + (p + q + r) (p + q + r)^T)   (Tonon 2004, eq. 9)
  Mat3d second_moment() const {
    const Vec3d s = p + q + r;
    return (outer(p, p) + outer(q, q) + outer(r, r) + outer(s, s)) * (d / 120);
  }
};

// The center of volume. The reference is a vertex, so that a distant mesh loses no digits.
Vec3d center_of(const TriangleMesh& mesh, double volume) {
  const Vec3d reference = mesh.positions[mesh.triangles[0][0]];
  Vec3d moment;
  for (const Triangle& t : mesh.triangles) moment += ReferenceTet(mesh, t, reference).first_moment();
  return reference + moment / volume;
}

// |r|^2 - r r^T, the inertia tensor of a unit mass at r.
Mat3d point_inertia(const Vec3d& r) {
  return Mat3d::identity() * length_squared(r) - outer(r, r);
}

MassProperties at_origin(double volume, double density, const Vec3d& moments_per_mass) {
  const double mass = volume * density;
  return {mass, volume, {}, Mat3d::diagonal(moments_per_mass * mass)};
}

}  // namespace

// Mirtich (1996, "Fast and accurate computation of polyhedral mass properties", J. Graphics Tools 1(2)) reduces the volume
// integrals to those of edges. The sum over tets (Tonon 2004, "Explicit exact formulas for the 3-D tetrahedron inertia
// tensor in terms of its vertex coordinates", J. Math. Stat. 1(1)) is as exact and shorter:
//   I = density (trace(S) - S),  S = integral of x x^T about the center
MassProperties mass_properties(const TriangleMesh& mesh, double density, const std::string& name) {
  require_density(name, density);
  check_indices(mesh, name.c_str());
  const MeshReport report = inspect(mesh);
  require_solid(mesh, report, name);

  MassProperties result;
  result.volume = report.signed_volume;
  result.mass = result.volume * density;
  result.center = center_of(mesh, result.volume);
  Mat3d second;
  for (const Triangle& t : mesh.triangles)
    second = second + ReferenceTet(mesh, t, result.center).second_moment();
  result.inertia = (Mat3d::identity() * trace(second) - second) * density;
  return result;
}

//   I = 2/5 m r^2
MassProperties sphere_mass_properties(double radius, double density) {
  require_size("sphere", "radius", radius);
  require_density("sphere", density);
  const double moment = 0.4 * radius * radius;
  return at_origin(4.0 / 3.0 * pi * radius * radius * radius, density, {moment, moment, moment});
}

//   I_x = m (y^2 + z^2) / 12
MassProperties box_mass_properties(const Vec3d& size, double density) {
  require_size("box", "size x", size.x);
  require_size("box", "size y", size.y);
  require_size("box", "size z", size.z);
  require_density("box", density);
  const Vec3d s{size.x * size.x, size.y * size.y, size.z * size.z};
  return at_origin(size.x * size.y * size.z, density, Vec3d{s.y + s.z, s.z + s.x, s.x + s.y} / 12.0);
}

// A cylinder of mass c and two hemispheres of mass b together, whose centers of mass lie 3/8 r beyond the cylinder's ends:
//   I_y = c r^2 / 2 + 2/5 b r^2
//   I_x = c (r^2 / 4 + l^2 / 12) + b (2/5 r^2 + l^2 / 4 + 3/8 l r)
MassProperties capsule_mass_properties(double radius, double length, double density) {
  require_size("capsule", "radius", radius);
  require_size("capsule", "length", length);
  require_density("capsule", density);
  const double r2 = radius * radius, l2 = length * length;
  const double ends = 4.0 / 3.0 * pi * r2 * radius, volume = pi * r2 * length + ends;
  const double b = ends / volume, c = 1 - b;
  const double along = c * r2 / 2 + 0.4 * b * r2;
  const double across = c * (r2 / 4 + l2 / 12) + b * (0.4 * r2 + l2 / 4 + 0.375 * length * radius);
  return at_origin(volume, density, {across, along, across});
}

//   I_y = m r^2 / 2,  I_x = m (r^2 / 4 + h^2 / 12)
MassProperties cylinder_mass_properties(double radius, double height, double density) {
  require_size("cylinder", "radius", radius);
  require_size("cylinder", "height", height);
  require_density("cylinder", density);
  const double r2 = radius * radius, across = r2 / 4 + height * height / 12;
  return at_origin(pi * r2 * height, density, {across, r2 / 2, across});
}

//   I' = s^5 R I R^T
MassProperties moved(const MassProperties& solid, const Transform& placement) {
  const double s = placement.scale, cube = s * s * s;
  const Mat3d turn = rotation_matrix(placement.rotation);
  const Mat3d inertia = turn * solid.inertia * transpose(turn) * (cube * s * s);
  return {solid.mass * cube, solid.volume * cube, placement.point(solid.center),
          (inertia + transpose(inertia)) * 0.5};
}

MassProperties with_mass(const MassProperties& solid, double mass) {
  require_positive("mass", "it", mass, "mass in kilograms");
  require_positive("solid", "its mass", solid.mass, "mass in kilograms");
  return {mass, solid.volume, solid.center, solid.inertia * (mass / solid.mass)};
}

// Parallel axis theorem (Huygens-Steiner):
//   c = sum m_k c_k / sum m_k,  I = sum I_k + m_k (|r_k|^2 - r_k r_k^T),  r_k = c_k - c
MassProperties combined(std::span<const MassProperties> parts) {
  if (parts.empty()) throw Error("combined: there are no parts; a compound needs at least one solid");
  MassProperties sum;
  // Relative to the first part, so that distant parts lose no digits.
  const Vec3d reference = parts[0].center;
  Vec3d moment;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    require_positive(fmt::format("combined: part {}", k), "its mass", parts[k].mass, "mass in kilograms");
    sum.mass += parts[k].mass;
    sum.volume += parts[k].volume;
    moment += (parts[k].center - reference) * parts[k].mass;
  }
  sum.center = reference + moment / sum.mass;
  for (const MassProperties& part : parts) sum.inertia = sum.inertia + inertia_about(part, sum.center);
  return sum;
}

Mat3d inertia_about(const MassProperties& solid, const Vec3d& point) {
  return solid.inertia + point_inertia(solid.center - point) * solid.mass;
}

namespace {

constexpr double coincident = 1e-9;  // relative difference of moments that count as equal

double moment_about(const Mat3d& inertia, const Vec3d& axis) {
  return dot(axis, inertia * axis);
}

// The frame with the largest trace, that is the smallest rotation, among the 24 right-handed frames along three
// perpendicular axes. The earliest wins where several are equal to rounding.
Mat3d nearest_frame(const Mat3d& axes) {
  Mat3d best;
  double best_trace = -4;
  for (int a = 0; a < 3; ++a)
    for (const int b : {(a + 1) % 3, (a + 2) % 3})
      for (const double sign_a : {1.0, -1.0})
        for (const double sign_b : {1.0, -1.0}) {
          const Vec3d x = axes.column[a] * sign_a, y = axes.column[b] * sign_b;
          const Mat3d frame{x, y, cross(x, y)};
          if (!(trace(frame) > best_trace + coincident)) continue;
          best = frame;
          best_trace = trace(frame);
        }
  return best;
}

// The axis of symmetry becomes the axis k that it is nearest to, by the smallest rotation: about e_k x u.
PrincipalFrame symmetric_frame(const Mat3d& inertia, Vec3d u) {
  int k = 0;
  for (const int i : {1, 2})
    if (std::abs(u[i]) > std::abs(u[k]) + coincident) k = i;
  if (u[k] < 0) u = -u;
  Vec3d e;
  e[k] = 1;
  const Vec3d n = cross(e, u);
  PrincipalFrame frame;
  frame.rotation = normalized(Quatd{n.x, n.y, n.z, 1 + u[k]});
  const double along = moment_about(inertia, u), across = (trace(inertia) - along) / 2;
  frame.moments = {across, across, across};
  frame.moments[k] = along;
  return frame;
}

std::string text_of(const Vec3d& m) {
  return fmt::format("{:g}, {:g}, {:g}", m.x, m.y, m.z);
}

}  // namespace

PrincipalFrame principal_frame(const Mat3d& inertia) {
  require_inertia(inertia);
  // The singular values of a symmetric positive matrix are its eigenvalues, descending.
  const Svd<double> s = svd(inertia);
  const double tolerance = coincident * s.sigma.x;
  const bool first_two = s.sigma.x - s.sigma.y <= tolerance, last_two = s.sigma.y - s.sigma.z <= tolerance;
  if (first_two && last_two) {
    const double mean = trace(inertia) / 3;
    return {{mean, mean, mean}, {}};
  }
  if (first_two || last_two) return symmetric_frame(inertia, s.v.column[first_two ? 2 : 0]);
  const Mat3d axes = nearest_frame(s.v);
  return {{moment_about(inertia, axes.column[0]), moment_about(inertia, axes.column[1]),
           moment_about(inertia, axes.column[2])},
          quaternion_of(axes)};
}

void require_inertia(const Mat3d& inertia, const std::string& name) {
  for (const Vec3d& c : inertia.column)
    if (!is_finite(c)) throw Error(name + ": the inertia tensor is not finite; expected moments in kg m^2");
  const double largest = std::sqrt(frobenius_squared(inertia)), rounding = 1e-6 * largest;
  if (frobenius_squared(inertia - transpose(inertia)) > rounding * rounding)
    throw Error(name +
                ": the inertia tensor is not symmetric; expected I_xy = I_yx, I_xz = I_zx, I_yz = I_zy");
  // U and V differ in sign where an eigenvalue is negative.
  const Svd<double> s = svd(inertia);
  const Vec3d moments{moment_about(inertia, s.v.column[0]), moment_about(inertia, s.v.column[1]),
                      moment_about(inertia, s.v.column[2])};
  const double least = std::min({moments.x, moments.y, moments.z});
  if (!(least > 0))
    throw Error(fmt::format("{}: the principal moments are {} kg m^2, expected three positive ones", name,
                            text_of(moments)));
  if (2 * moments.x > trace(inertia) + rounding)
    throw Error(fmt::format(
        "{}: the principal moments are {} kg m^2, but in no body is one larger than the sum of the "
        "other two; give the moments of a solid",
        name, text_of(moments)));
}

}  // namespace souple
