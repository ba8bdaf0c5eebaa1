#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/mat3.h"
#include "souple/math/transform.h"

#include <span>
#include <string>

namespace souple {

// Mass properties of the solid of a rigid body. Everything is computed in double.

/// Mass, center of mass and inertia tensor of a solid.
struct MassProperties {
  double mass{};    ///< kg
  double volume{};  ///< m^3
  Vec3d center{};   ///< center of mass [m]
  Mat3d inertia{};  ///< symmetric, about the center of mass, in the axes of the solid's frame [kg m^2]
};

/// Properties of the solid inside a closed triangle mesh, wound outward, of uniform density [kg/m^3]. Exact for the
/// polyhedron up to rounding, wherever it lies. Vertices that coincide are one (mesh_report.h), so that a UV seam is no
/// hole; a part that is wound inward inside another is a cavity. Throws Error, with `name` and the remedy, if the mesh
/// is not closed, not consistently wound, or encloses no or a negative volume. Also throws if an index is out of range,
/// or if the density is not finite and positive.
MassProperties mass_properties(const TriangleMesh& mesh, double density, const std::string& name = "mesh");

// Solids at the origin, Y up, as in builders.h: lengths in m, density in kg/m^3. Each throws Error for a length or
// density that is not finite and positive.
MassProperties sphere_mass_properties(double radius, double density);
MassProperties box_mass_properties(const Vec3d& size, double density);
/// A cylinder of the given `length` between two hemispheres.
MassProperties capsule_mass_properties(double radius, double length, double density);
MassProperties cylinder_mass_properties(double radius, double height, double density);

/// Properties of the solid at another place: rotated, moved, and scaled at equal density (mass s^3, inertia s^5).
MassProperties moved(const MassProperties& solid, const Transform& placement);
/// Properties of a solid of equal shape with another mass [kg]. Throws Error unless it is finite and positive.
MassProperties with_mass(const MassProperties& solid, double mass);
/// Properties of several solids that are rigidly connected; volume that parts share counts in each of them. Throws
/// Error without parts and for a part without mass.
MassProperties combined(std::span<const MassProperties> parts);

/// The inertia tensor about another point than the center of mass [kg m^2].
Mat3d inertia_about(const MassProperties& solid, const Vec3d& point);

/// Principal moments and axes: I = R diag(moments) R^T, R the rotation.
struct PrincipalFrame {
  Vec3d moments{};   ///< about the axes x, y, z of the principal frame [kg m^2]
  Quatd rotation{};  ///< from the principal frame to the frame of the tensor, unit
};
/// The right-handed principal frame that is nearest to the tensor's own frame; for a box along the axes it is the identity.
/// Moments coincide if they differ by less than 1e-9 of the largest; then the axes are chosen uniquely. A ball gets the
/// identity, a cylinder the smallest rotation that turns an axis into the axis of symmetry. Such moments are equal in
/// the result. Throws Error as require_inertia does.
PrincipalFrame principal_frame(const Mat3d& inertia);

/// Throws Error, with `name`, unless a body can have this inertia tensor. It must be finite and symmetric with positive
/// moments. No moment may exceed the sum of the other two (beyond rounding, 1e-6 of the largest).
void require_inertia(const Mat3d& inertia, const std::string& name = "inertia");

}  // namespace souple
