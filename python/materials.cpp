#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/objects/kind_traits.h"
#include "souple/objects/material_fields.h"

#include <limits>

namespace souple::python {

namespace {

template <class M>
void bind_material(py::module_& m, const char* name) {
  Struct<M> material(m, name);
  visit_fields<M>([&]<auto member>(Field<member>, const char* field_name, const auto&...) {
    material.template field<member>(field_name);
  });
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
  bind_material<ClothMaterial>(m, "ClothMaterial");
  bind_material<SoftBodyMaterial>(m, "SoftBodyMaterial");
  bind_material<RopeMaterial>(m, "RopeMaterial");
  bind_material<GrainsMaterial>(m, "GrainsMaterial");
  bind_material<FluidMaterial>(m, "FluidMaterial");
  bind_material<ObstacleMaterial>(m, "ObstacleMaterial");
  bind_material<RigidBodyMaterial>(m, "RigidBodyMaterial");
  m.attr("rigid") = std::numeric_limits<double>::infinity();
  m.def("_material_preset", &preset);
  m.def("_material_names", &material::names);
  m.def("kind_of", &kind_of, "material"_a, doc("kind_of"));
}

}  // namespace souple::python
