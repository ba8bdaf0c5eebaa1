#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/tet_mesh.h"

namespace souple::python {

namespace {

using Options = std::optional<ObjectOptions>;

ObjectOptions options_of(const Options& options, const py::kwargs& kwargs, const char* function) {
  return with_keywords(options, kwargs, function);
}

/// Defines a function that adds an object of something with a material: keywords are members of ObjectOptions.
template <class Source, class Material>
void def_add(WorldClass& world, const char* name, const char* source, const char* material) {
  const char* const text = doc(std::string("World.") + name);
  world.def(
      name,
      [name](BoundWorld& self, const Source& from, const Material& of, const Options& options,
             const py::kwargs& kwargs) {
        World& used = self.use(name);
        const ObjectOptions all = options_of(options, kwargs, name);
        if constexpr (std::is_same_v<Material, ClothMaterial>) return used.add_cloth(from, of, all);
        if constexpr (std::is_same_v<Material, SoftBodyMaterial>) return used.add_soft_body(from, of, all);
        if constexpr (std::is_same_v<Material, GrainsMaterial>) return used.add_grains(from, of, all);
        if constexpr (std::is_same_v<Material, FluidMaterial>) return used.add_fluid(from, of, all);
        if constexpr (std::is_same_v<Material, RigidBodyMaterial>) return used.add_rigid_body(from, of, all);
      },
      py::arg(source), py::arg_v("material", Material{}, material), py::arg("options") = py::none(), text);
}

ObjectId add_embedded(BoundWorld& world, const TriangleMesh& surface, const SoftBodyMaterial& material,
                      const LatticeOptions& lattice, const Options& options, const py::kwargs& kwargs) {
  World& used = world.use("add_soft_body");
  return used.add_soft_body(surface, material, lattice, options_of(options, kwargs, "add_soft_body"));
}

ObjectId add_rope(BoundWorld& world, std::span<const Vec3d> points, std::uint32_t segments,
                  const RopeMaterial& material, const Options& options, const py::kwargs& kwargs) {
  World& used = world.use("add_rope");
  return used.add_rope(points, segments, material, options_of(options, kwargs, "add_rope"));
}

ObjectId add_parts(BoundWorld& world, const std::vector<RigidPart>& parts, const RigidBodyMaterial& material,
                   const Options& options, const py::kwargs& kwargs) {
  World& used = world.use("add_rigid_body");
  return used.add_rigid_body(parts, material, options_of(options, kwargs, "add_rigid_body"));
}

ObjectId add_obstacle(BoundWorld& world, const TriangleMesh& mesh, const ObstacleMaterial& material,
                      const ObstacleMotion& motion, const Options& options, const py::kwargs& kwargs) {
  World& used = world.use("add_obstacle");
  return used.add_obstacle(mesh, material, motion, options_of(options, kwargs, "add_obstacle"));
}

void bind_adding(WorldClass& world) {
  def_add<TriangleMesh, ClothMaterial>(world, "add_cloth", "mesh", "ClothMaterial()");
  def_add<TetMesh, SoftBodyMaterial>(world, "add_soft_body", "mesh", "SoftBodyMaterial()");
  world.def("add_soft_body", &add_embedded, py::arg("surface"),
            py::arg_v("material", SoftBodyMaterial{}, "SoftBodyMaterial()"),
            py::arg_v("lattice", LatticeOptions{}, "LatticeOptions()"), py::arg("options") = py::none(),
            doc("World.add_soft_body"));
  world.def("add_rope", &add_rope, py::arg("points"), py::arg("segments"),
            py::arg_v("material", RopeMaterial{}, "RopeMaterial()"), py::arg("options") = py::none(),
            doc("World.add_rope"));
  def_add<std::span<const Vec3d>, GrainsMaterial>(world, "add_grains", "centers", "GrainsMaterial()");
  def_add<TriangleMesh, FluidMaterial>(world, "add_fluid", "surface", "FluidMaterial()");
  def_add<std::span<const Vec3d>, FluidMaterial>(world, "add_fluid", "centers", "FluidMaterial()");
  def_add<TriangleMesh, RigidBodyMaterial>(world, "add_rigid_body", "mesh", "RigidBodyMaterial()");
  def_add<Shape, RigidBodyMaterial>(world, "add_rigid_body", "shape", "RigidBodyMaterial()");
  world.def("add_rigid_body", &add_parts, py::arg("parts"),
            py::arg_v("material", RigidBodyMaterial{}, "RigidBodyMaterial()"),
            py::arg("options") = py::none(), doc("World.add_rigid_body"));
  world.def("add_obstacle", &add_obstacle, py::arg("mesh"),
            py::arg_v("material", ObstacleMaterial{}, "ObstacleMaterial()"),
            py::arg_v("motion", ObstacleMotion{}, "ObstacleMotion()"), py::arg("options") = py::none(),
            doc("World.add_obstacle"));
}

void bind_rigid(WorldClass& world) {
  world
      .def("rigid_body", checked("rigid_body", &World::rigid_body), py::arg("object"),
           doc("World.rigid_body"))
      .def("set_kinematic", checked("set_kinematic", &World::set_kinematic), py::arg("body"),
           py::arg("kinematic"), doc("World.set_kinematic"))
      .def("is_kinematic", checked("is_kinematic", &World::is_kinematic), py::arg("body"),
           "See set_kinematic.")
      .def("move_body", checked("move_body", &World::move_body), py::arg("body"), py::arg("pose"),
           doc("World.move_body"))
      .def("set_body_velocity", checked("set_body_velocity", &World::set_body_velocity), py::arg("body"),
           py::arg("velocity"), py::arg("angular_velocity"), doc("World.set_body_velocity"));
}

template <class M>
void def_material(WorldClass& world, const char* name, const M& (World::*function)(ObjectId) const) {
  world.def(name, checked(name, function), py::arg("object"),
            "A copy of the object's material. Throws Error for other kinds.");
}

void bind_materials_of(WorldClass& world) {
  world.def("set_material", checked("set_material", &World::set_material), py::arg("object"),
            py::arg("material"), doc("World.set_material"));
  world.def("material", checked("material", &World::material), py::arg("object"),
            "A copy of the object's material.");
  def_material(world, "cloth_material", &World::cloth_material);
  def_material(world, "soft_body_material", &World::soft_body_material);
  def_material(world, "rope_material", &World::rope_material);
  def_material(world, "grains_material", &World::grains_material);
  def_material(world, "obstacle_material", &World::obstacle_material);
  def_material(world, "rigid_body_material", &World::rigid_body_material);
  def_material(world, "fluid_material", &World::fluid_material);
}

}  // namespace

void bind_world_objects(WorldClass& world) {
  bind_adding(world);
  bind_rigid(world);
  bind_materials_of(world);
  world
      .def("remove", checked<void, ObjectId>("remove", &World::remove), py::arg("object"),
           "Removes an object.")
      .def("objects", checked("objects", &World::objects), doc("World.objects"))
      .def("contains", checked("contains", &World::contains), py::arg("object"), "Whether the object exists.")
      .def("find_object", checked("find_object", &World::find_object), py::arg("name"),
           doc("World.find_object"))
      .def("name", checked("name", &World::name), py::arg("object"), "The name of an object.")
      .def("kind", checked("kind", &World::kind), py::arg("object"), "The kind of an object.")
      .def("set_collision_groups", checked("set_collision_groups", &World::set_collision_groups),
           py::arg("object"), py::arg("groups"), py::arg("mask") = 0xffffffffu,
           doc("World.set_collision_groups"))
      .def("collision_groups", checked("collision_groups", &World::collision_groups), py::arg("object"),
           "See set_collision_groups.")
      .def("collision_mask", checked("collision_mask", &World::collision_mask), py::arg("object"),
           "See set_collision_groups.")
      .def("self_collision", checked("self_collision", &World::self_collision), py::arg("object"),
           doc("World.self_collision"))
      .def("set_layer", checked("set_layer", &World::set_layer), py::arg("object"), py::arg("layer"),
           doc("World.set_layer"))
      .def("layer", checked("layer", &World::layer), py::arg("object"), "See set_layer.")
      .def("set_motion", checked("set_motion", &World::set_motion), py::arg("object"), py::arg("motion"),
           doc("World.set_motion"))
      .def("motion", checked("motion", &World::motion), py::arg("object"),
           "The motion of an obstacle or kinematic body.");
}

}  // namespace souple::python
