#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstdint>
#include <span>

namespace souple {

/// The part of a mesh on the given vertices (ascending). It has these vertices in order, and the faces all of whose
/// corners are among them, with their data. UVs and normals that no remaining face uses are dropped.
TriangleMesh submesh(const TriangleMesh& mesh, std::span<const std::uint32_t> vertices);

}  // namespace souple
