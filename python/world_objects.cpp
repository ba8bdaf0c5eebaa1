#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/tet_mesh.h"

namespace souple::python {

namespace {

/// add_...(source..., material, options): keywords are members of ObjectOptions.
template <class... Parameters>
using Adding = ObjectId (World::*)(Parameters..., const ObjectOptions&);

template <class Material, class Source, Adding<Source, const Material&> add>
void def_add(WorldClass& world, const char* source) {
  def_with_options<add>(world, py::arg(source), with_default<Material>("material"), "options"_a = py::none());
}

void bind_adding(WorldClass& world) {
  using Points = std::span<const Vec3d>;
  using Mesh = const TriangleMesh&;
  def_add<ClothMaterial, Mesh, &World::add_cloth>(world, "mesh");
  def_add<SoftBodyMaterial, const TetMesh&, &World::add_soft_body>(world, "mesh");
  constexpr Adding<Mesh, const SoftBodyMaterial&, const LatticeOptions&> embedded = &World::add_soft_body;
  def_with_options<embedded>(world, "surface"_a, with_default<SoftBodyMaterial>("material"),
                             with_default<LatticeOptions>("lattice"), "options"_a = py::none());
  def_with_options<&World::add_rope>(world, "points"_a, "segments"_a, with_default<RopeMaterial>("material"),
                                     "options"_a = py::none());
  def_add<GrainsMaterial, Points, &World::add_grains>(world, "centers");
  def_add<FluidMaterial, Mesh, &World::add_fluid>(world, "surface");
  def_add<FluidMaterial, Points, &World::add_fluid>(world, "centers");
  def_add<RigidBodyMaterial, Mesh, &World::add_rigid_body>(world, "mesh");
  def_add<RigidBodyMaterial, const Shape&, &World::add_rigid_body>(world, "shape");
  world.def(
      "add_rigid_body",
      [](BoundWorld& self, const std::vector<RigidPart>& parts, const RigidBodyMaterial& material,
         const std::optional<ObjectOptions>& options, const py::kwargs& kwargs) {
        World& used = self.use("add_rigid_body");
        return used.add_rigid_body(parts, material, with_keywords(options, kwargs, "add_rigid_body"));
      },
      "parts"_a, with_default<RigidBodyMaterial>("material"), "options"_a = py::none(),
      doc("World.add_rigid_body"));
  def_with_options<&World::add_obstacle>(world, "mesh"_a, with_default<ObstacleMaterial>("material"),
                                         with_default<ObstacleMotion>("motion"), "options"_a = py::none());
}

void bind_rigid(WorldClass& world) {
  def<&World::rigid_body>(world, "object"_a);
  def<&World::set_kinematic>(world, "body"_a, "kinematic"_a);
  def<&World::is_kinematic>(world, "body"_a, "See set_kinematic.");
  def<&World::move_body>(world, "body"_a, "pose"_a);
  def<&World::set_body_velocity>(world, "body"_a, "velocity"_a, "angular_velocity"_a);
}

void bind_materials_of(WorldClass& world) {
  def<&World::set_material>(world, "object"_a, "material"_a);
  def<&World::material>(world, "object"_a, "A copy of the object's material.");
  const char* const copy = "A copy of the object's material. Throws Error for other kinds.";
  def<&World::cloth_material>(world, "object"_a, copy);
  def<&World::soft_body_material>(world, "object"_a, copy);
  def<&World::rope_material>(world, "object"_a, copy);
  def<&World::grains_material>(world, "object"_a, copy);
  def<&World::obstacle_material>(world, "object"_a, copy);
  def<&World::rigid_body_material>(world, "object"_a, copy);
  def<&World::fluid_material>(world, "object"_a, copy);
}

}  // namespace

void bind_world_objects(WorldClass& world) {
  bind_adding(world);
  bind_rigid(world);
  bind_materials_of(world);
  def<py::overload_cast<ObjectId>(&World::remove)>(world, "object"_a, "Removes an object.");
  def<&World::objects>(world);
  def<&World::contains>(world, "object"_a, "Whether the object exists.");
  def<&World::find_object>(world, "name"_a);
  def<&World::name>(world, "object"_a, "The name of an object.");
  def<&World::kind>(world, "object"_a, "The kind of an object.");
  def<&World::set_collision_groups>(world, "object"_a, "groups"_a, "mask"_a = 0xffffffffu);
  def<&World::collision_groups>(world, "object"_a, "See set_collision_groups.");
  def<&World::collision_mask>(world, "object"_a, "See set_collision_groups.");
  def<&World::self_collision>(world, "object"_a);
  def<&World::set_layer>(world, "object"_a, "layer"_a);
  def<&World::layer>(world, "object"_a, "See set_layer.");
  def<&World::set_motion>(world, "object"_a, "motion"_a);
  def<&World::motion>(world, "object"_a, "The motion of an obstacle or kinematic body.");
}

}  // namespace souple::python
