#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <string>

namespace souple {

/// How fine a lattice is: exactly one of the two is set.
struct LatticeOptions {
  double cell_size = 0;   ///< side of the lattice's cubes, meters; a cube holds 12 tets
  std::size_t cells = 0;  ///< wanted number of tets; the size is searched for (usually within 5 %)
};

/// A body-centered cubic lattice of tets that covers a closed surface: all its tets are congruent, with
/// dihedral angles of 60 and 90 degrees only, and look the same from every axis. (Molino et al. 2003, "A
/// crystalline, red green strategy for meshing highly deformable objects with tetrahedra", section 3; no
/// red-green refinement here.)
struct Lattice {
  TetMesh mesh;
  double cell_size{};       ///< meters
  std::size_t inner{};      ///< tets wholly inside the surface
  std::size_t crossed{};    ///< tets that the surface passes through
  double surface_volume{};  ///< m^3 enclosed by the surface
  double lattice_volume{};  ///< m^3 of the tets; larger: scale a density by surface_volume / lattice_volume
  std::size_t pieces{};     ///< separate parts of the lattice; bodies closer than a cell grow together
};

/// Covers the solid inside `mesh` (repaired first, see mesh_report.h; cavities stay hollow if their surface
/// is wound inward). Keeps the tets that the surface crosses, so thin parts are covered too, and those
/// inside; every vertex of the surface lies in a kept tet. Throws Error, starting with `name`, if the surface
/// is open, encloses no volume or is not finite, or if the lattice would need more than 4 million cubes.
Lattice build_lattice(const TriangleMesh& mesh, const LatticeOptions& options,
                      const std::string& name = "mesh");

}  // namespace souple
