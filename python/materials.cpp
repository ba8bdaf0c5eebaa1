#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/objects/kind_traits.h"

#include <limits>

namespace souple::python {

namespace {

void bind_cloth_material(py::module_& m) {
  using M = ClothMaterial;
  Struct<M>(m, "ClothMaterial")
      .field<&M::areal_density>("areal_density")
      .field<&M::membrane_stiffness>("membrane_stiffness")
      .field<&M::weft_stiffness>("weft_stiffness")
      .field<&M::shear_stiffness>("shear_stiffness")
      .field<&M::poisson_ratio>("poisson_ratio")
      .field<&M::bending_stiffness>("bending_stiffness")
      .field<&M::thickness>("thickness")
      .field<&M::friction>("friction")
      .field<&M::kinetic_friction>("kinetic_friction")
      .field<&M::restitution>("restitution")
      .field<&M::damping_time>("damping_time")
      .field<&M::damping>("damping")
      .field<&M::air_drag>("air_drag")
      .field<&M::air_lift>("air_lift")
      .field<&M::stretch>("stretch")
      .field<&M::bending>("bending")
      .field<&M::pbd_stretch>("pbd_stretch")
      .field<&M::pbd_bending>("pbd_bending");
}

void bind_soft_body_material(py::module_& m) {
  using M = SoftBodyMaterial;
  Struct<M>(m, "SoftBodyMaterial")
      .field<&M::young_modulus>("young_modulus")
      .field<&M::poisson_ratio>("poisson_ratio")
      .field<&M::density>("density")
      .field<&M::thickness>("thickness")
      .field<&M::friction>("friction")
      .field<&M::kinetic_friction>("kinetic_friction")
      .field<&M::restitution>("restitution")
      .field<&M::damping_time>("damping_time")
      .field<&M::damping>("damping")
      .field<&M::model>("model")
      .field<&M::pbd_stiffness>("pbd_stiffness");
}

void bind_rope_material(py::module_& m) {
  using M = RopeMaterial;
  Struct<M>(m, "RopeMaterial")
      .field<&M::radius>("radius")
      .field<&M::young_modulus>("young_modulus")
      .field<&M::density>("density")
      .field<&M::bending_stiffness>("bending_stiffness")
      .field<&M::friction>("friction")
      .field<&M::kinetic_friction>("kinetic_friction")
      .field<&M::restitution>("restitution")
      .field<&M::damping_time>("damping_time")
      .field<&M::damping>("damping")
      .field<&M::pbd_stretch>("pbd_stretch")
      .field<&M::pbd_bending>("pbd_bending");
}

void bind_grains_material(py::module_& m) {
  using M = GrainsMaterial;
  Struct<M>(m, "GrainsMaterial")
      .field<&M::radius>("radius")
      .field<&M::density>("density")
      .field<&M::friction>("friction")
      .field<&M::kinetic_friction>("kinetic_friction")
      .field<&M::rolling_friction>("rolling_friction")
      .field<&M::restitution>("restitution")
      .field<&M::damping>("damping");
}

void bind_fluid_material(py::module_& m) {
  using M = FluidMaterial;
  Struct<M>(m, "FluidMaterial")
      .field<&M::spacing>("spacing")
      .field<&M::density>("density")
      .field<&M::viscosity>("viscosity")
      .field<&M::xsph>("xsph")
      .field<&M::surface_tension>("surface_tension")
      .field<&M::contact_angle>("contact_angle")
      .field<&M::vorticity>("vorticity")
      .field<&M::air_drag>("air_drag")
      .field<&M::foam>("foam")
      .field<&M::friction>("friction")
      .field<&M::restitution>("restitution");
}

void bind_obstacle_material(py::module_& m) {
  using M = ObstacleMaterial;
  Struct<M>(m, "ObstacleMaterial")
      .field<&M::thickness>("thickness")
      .field<&M::friction>("friction")
      .field<&M::kinetic_friction>("kinetic_friction")
      .field<&M::restitution>("restitution");
}

void bind_rigid_body_material(py::module_& m) {
  using M = RigidBodyMaterial;
  Struct<M>(m, "RigidBodyMaterial")
      .field<&M::density>("density")
      .field<&M::thickness>("thickness")
      .field<&M::friction>("friction")
      .field<&M::kinetic_friction>("kinetic_friction")
      .field<&M::restitution>("restitution");
}

/// A copy of the preset with this name; throws Error that lists the names.
py::object preset(const std::string& name) {
  if (const ClothMaterial* found = material::find_cloth(name)) return py::cast(*found);
  if (const SoftBodyMaterial* found = material::find_soft_body(name)) return py::cast(*found);
  if (const RopeMaterial* found = material::find_rope(name)) return py::cast(*found);
  if (const GrainsMaterial* found = material::find_grains(name)) return py::cast(*found);
  if (const FluidMaterial* found = material::find_fluid(name)) return py::cast(*found);
  return py::none();
}

}  // namespace

void bind_materials(py::module_& m) {
  bind_cloth_material(m);
  bind_soft_body_material(m);
  bind_rope_material(m);
  bind_grains_material(m);
  bind_fluid_material(m);
  bind_obstacle_material(m);
  bind_rigid_body_material(m);
  m.attr("rigid") = std::numeric_limits<double>::infinity();
  m.def("_material_preset", &preset);
  m.def("_material_names", &material::names);
  m.def("kind_of", &kind_of, py::arg("material"), doc("kind_of"));
}

}  // namespace souple::python
