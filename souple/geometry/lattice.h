#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <string>
#include <vector>

namespace souple {

/// Resolution of a lattice: exactly one member is set.
struct LatticeOptions {
  double cell_size = 0;   ///< side of the lattice's cubes [m]; a cube holds 12 tets
  std::size_t cells = 0;  ///< target number of tets; a search finds the cell size (usually within 5 %)
};

/// A body-centered cubic lattice of tets that covers a closed surface. All tets are congruent, with dihedral angles of
/// 60 and 90 degrees only, and no axis is special. Source: Molino et al. 2003, "A crystalline, red green strategy for
/// meshing highly deformable objects with tetrahedra", section 3, without the red-green refinement.
struct Lattice {
  TetMesh mesh;
  double cell_size{};       ///< meters
  std::size_t inner{};      ///< tets entirely inside the surface
  std::size_t crossed{};    ///< tets that the surface crosses
  double surface_volume{};  ///< volume enclosed by the surface [m^3]
  /// Volume of the tets [m^3]; larger: scale a density by surface_volume / lattice_volume.
  double lattice_volume{};
  std::size_t pieces{};  ///< connected components of the lattice; bodies closer than a cell merge
  std::vector<std::string> sentences;  ///< holes of the surface that were closed
};

/// Covers the solid inside `mesh`, which is repaired first (mesh_report.h); cavities stay hollow if their
/// surface is wound inward. Keeps tets inside the surface and tets that it crosses, so that thin parts are covered.
/// Every vertex of the surface is in a kept tet. Closes holes whose area is less than a fifth of the surface's with
/// fans of triangles (close_holes.h), as the eyes of a head. Throws Error, starting with `name`, if the surface has
/// larger holes, encloses no volume or is not finite. Also throws if the lattice would need more than 4 million cubes.
Lattice build_lattice(const TriangleMesh& mesh, const LatticeOptions& options,
                      const std::string& name = "mesh");

}  // namespace souple
