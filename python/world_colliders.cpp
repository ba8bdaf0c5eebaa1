#include "python/bind.h"
#include "python/bound_world.h"

namespace souple::python {

namespace {

template <class T>
using Given = std::optional<T>;

void bind_flow(WorldClass& world) {
  world
      .def(
          "add_emitter",
          [](BoundWorld& self, ObjectId fluid, const Given<Emitter>& emitter, const py::kwargs& kwargs) {
            return self.use("add_emitter").add_emitter(fluid, with_keywords(emitter, kwargs, "add_emitter"));
          },
          py::arg("fluid"), py::arg("emitter") = py::none(), doc("World.add_emitter"))
      .def("set_emitter", checked("set_emitter", &World::set_emitter), py::arg("id"), py::arg("emitter"),
           doc("World.set_emitter"))
      .def("remove", checked<void, EmitterId>("remove", &World::remove), py::arg("emitter"),
           "Removes an emitter.")
      .def(
          "add_drain",
          [](BoundWorld& self, const Given<Drain>& drain, const py::kwargs& kwargs) {
            return self.use("add_drain").add_drain(with_keywords(drain, kwargs, "add_drain"));
          },
          py::arg("drain") = py::none(), doc("World.add_drain"))
      .def("remove", checked<void, DrainId>("remove", &World::remove), py::arg("drain"), "Removes a drain.")
      .def("fluid_force", checked("fluid_force", &World::fluid_force), py::arg("collider"),
           doc("World.fluid_force"));
}

void bind_forces(WorldClass& world) {
  world
      .def(
          "add_force_field",
          [](BoundWorld& self, const py::object& field) {
            return self.use("add_force_field").add_force_field(force_field_of(self, field));
          },
          py::arg("field"),
          "Adds the force [N] that field(position, velocity, mass, time) returns for a particle, each "
          "substep.")
      .def(
          "add_vertex_force_field",
          [](BoundWorld& self, const py::object& field) {
            return self.use("add_vertex_force_field").add_force_field(vertex_force_field_of(self, field));
          },
          py::arg("field"),
          "Adds the force [N] that field(point), of a ForcePoint, returns for a particle, each substep.")
      .def("remove", checked<void, ForceFieldId>("remove", &World::remove), py::arg("field"),
           "Removes a force field.")
      .def("clear_force_fields", checked("clear_force_fields", &World::clear_force_fields),
           "Removes all force fields.")
      .def(
          "set_wind",
          [](BoundWorld& self, const Given<Wind>& wind, const py::kwargs& kwargs) {
            World& used = self.use("set_wind");
            used.set_wind(
                with_keywords(std::optional(wind.value_or(used.settings().wind)), kwargs, "set_wind"));
          },
          py::arg("wind") = py::none(), "Sets Settings.wind, or the members of it that keywords name.")
      .def("set_wind_exposure", checked("set_wind_exposure", &World::set_wind_exposure), py::arg("object"),
           py::arg("exposure"), doc("World.set_wind_exposure"))
      .def("wind_exposure", checked("wind_exposure", &World::wind_exposure), py::arg("object"),
           "See set_wind_exposure.");
}

void bind_pairs(WorldClass& world) {
  world
      .def("set_pair", checked("set_pair", &World::set_pair), py::arg("a"), py::arg("b"), py::arg("friction"),
           py::arg("restitution"), py::arg("kinetic_friction") = py::none(), doc("World.set_pair"))
      .def("set_collide", checked("set_collide", &World::set_collide), py::arg("a"), py::arg("b"),
           py::arg("collide"), doc("World.set_collide"))
      .def("set_user_data", checked<void, ObjectId, std::uint64_t>("set_user_data", &World::set_user_data),
           py::arg("object"), py::arg("data"), doc("World.set_user_data"))
      .def("set_user_data", checked<void, ColliderId, std::uint64_t>("set_user_data", &World::set_user_data),
           py::arg("collider"), py::arg("data"), doc("World.set_user_data"))
      .def("user_data", checked<std::uint64_t, ObjectId>("user_data", &World::user_data), py::arg("object"),
           "See set_user_data.")
      .def("user_data", checked<std::uint64_t, ColliderId>("user_data", &World::user_data),
           py::arg("collider"), "See set_user_data.");
}

}  // namespace

void bind_world_colliders(WorldClass& world) {
  world
      .def(
          "add_collider",
          [](BoundWorld& self, const Shape& shape, const Given<ColliderOptions>& options,
             const py::kwargs& kwargs) {
            return self.use("add_collider")
                .add_collider(shape, with_keywords(options, kwargs, "add_collider"));
          },
          py::arg("shape"), py::arg("options") = py::none(),
          "Adds a shape that objects collide with. Keywords are members of ColliderOptions.")
      .def("remove", checked<void, ColliderId>("remove", &World::remove), py::arg("collider"),
           "Removes a collider.")
      .def(
          "set_collider",
          [](BoundWorld& self, ColliderId id, const Shape& shape, const Given<ColliderOptions>& options,
             const py::kwargs& kwargs) {
            World& used = self.use("set_collider");
            used.set_collider(id, shape,
                              with_keywords(std::optional(options.value_or(used.collider_options(id))),
                                            kwargs, "set_collider"));
          },
          py::arg("collider"), py::arg("shape"), py::arg("options") = py::none(),
          "Replaces the shape, and the options or the members of them that keywords name.")
      .def("move_collider", checked("move_collider", &World::move_collider), py::arg("collider"),
           py::arg("pose"), doc("World.move_collider"))
      .def("colliders", checked("colliders", &World::colliders), "All colliders, in order of addition.")
      .def("shape", checked("shape", &World::shape), py::arg("collider"),
           "A copy of the shape of a collider.")
      .def("collider_options", checked("collider_options", &World::collider_options), py::arg("collider"),
           "A copy of the options of a collider.")
      .def("collider_pose", checked("collider_pose", &World::collider_pose), py::arg("collider"),
           doc("World.collider_pose"))
      .def("find_collider", checked("find_collider", &World::find_collider), py::arg("name"),
           "The collider of this name. Throws Error with the nearest name.");
  bind_flow(world);
  bind_forces(world);
  bind_pairs(world);
}

}  // namespace souple::python
