#pragma once

#include "souple/collision/shapes.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/new_object.h"
#include "souple/objects/obstacle_motion.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

// The kinds of objects. The file of each fills in its functions, and makes objects of what users add, as the functions
// World::add_... say. Imports throw Error, beginning with the object's name.

namespace souple {

namespace kinds {
extern const KindFunctions cloth, soft_body, rope, grains, obstacle, fluid, rigid_body;
/// In the order of ObjectKind.
inline constexpr std::array<const KindFunctions*, std::variant_size_v<Material>> all{
    &cloth, &soft_body, &rope, &grains, &obstacle, &fluid, &rigid_body};
}  // namespace kinds

NewObject import_cloth(std::string name, const TriangleMesh& mesh, const ClothMaterial& material,
                       const ObjectOptions& options);
NewObject import_soft_body(std::string name, const TetMesh& mesh, const SoftBodyMaterial& material,
                           const ObjectOptions& options);
NewObject import_soft_body(std::string name, const TriangleMesh& surface, const SoftBodyMaterial& material,
                           const LatticeOptions& lattice, const ObjectOptions& options);
NewObject import_rope(std::string name, std::span<const Vec3d> points, std::uint32_t segments,
                      const RopeMaterial& material, const ObjectOptions& options);
NewObject import_grains(std::string name, std::span<const Vec3d> centers, const GrainsMaterial& material,
                        const ObjectOptions& options);
NewObject import_fluid(std::string name, std::span<const Vec3d> centers, const FluidMaterial& material,
                       const ObjectOptions& options);
/// Fills a closed surface.
NewObject import_fluid(std::string name, const TriangleMesh& surface, const FluidMaterial& material,
                       const ObjectOptions& options);
NewObject import_obstacle(std::string name, const TriangleMesh& mesh, const ObstacleMaterial& material,
                          ObstacleMotion motion, const ObjectOptions& options);

/// The convex hulls of the connected pieces of a mesh, as one body. Its mass is that of the solid inside a closed mesh,
/// otherwise that of the hulls.
NewObject import_rigid_body(std::string name, const TriangleMesh& mesh, const RigidBodyMaterial& material,
                            const ObjectOptions& options);
/// A sphere, box, capsule or cylinder, exactly.
NewObject import_rigid_body(std::string name, const Shape& shape, const RigidBodyMaterial& material,
                            const ObjectOptions& options);
/// Several of these.
NewObject import_rigid_body(std::string name, std::span<const RigidPart> parts,
                            const RigidBodyMaterial& material, const ObjectOptions& options);

}  // namespace souple
