#include "python/bind.h"
#include "python/bound_world.h"

namespace souple::python {

namespace {

void bind_flow(WorldClass& world) {
  def_with_options<&World::add_emitter>(world, "fluid"_a, "emitter"_a = py::none());
  def<&World::set_emitter>(world, "id"_a, "emitter"_a);
  def<py::overload_cast<EmitterId>(&World::remove)>(world, "emitter"_a, "Removes an emitter.");
  def_with_options<&World::add_drain>(world, "drain"_a = py::none());
  def<py::overload_cast<DrainId>(&World::remove)>(world, "drain"_a, "Removes a drain.");
  def<&World::leave_out_covered>(world);
  def<&World::fluid_force>(world, "collider"_a);
}

void bind_forces(WorldClass& world) {
  world
      .def(
          "add_force_field",
          [](BoundWorld& self, const py::object& field) {
            return self.use("add_force_field").add_force_field(force_field_of(self, field));
          },
          "field"_a,
          "Adds the force [N] that field(position, velocity, mass, time) returns for a particle, each "
          "substep.")
      .def(
          "add_vertex_force_field",
          [](BoundWorld& self, const py::object& field) {
            return self.use("add_vertex_force_field").add_force_field(vertex_force_field_of(self, field));
          },
          "field"_a,
          "Adds the force [N] that field(point), of a ForcePoint, returns for a particle, each substep.");
  def<py::overload_cast<ForceFieldId>(&World::remove)>(world, "field"_a, "Removes a force field.");
  def<&World::clear_force_fields>(world, "Removes all force fields.");
  world.def(
      "set_wind",
      [](BoundWorld& self, const std::optional<Wind>& wind, const py::kwargs& kwargs) {
        World& used = self.use("set_wind");
        used.set_wind(with_keywords(std::optional(wind.value_or(used.settings().wind)), kwargs, "set_wind"));
      },
      "wind"_a = py::none(), "Sets Settings.wind, or the members of it that keywords name.");
  def<&World::set_wind_exposure>(world, "object"_a, "exposure"_a);
  def<&World::wind_exposure>(world, "object"_a, "See set_wind_exposure.");
}

void bind_pairs(WorldClass& world) {
  def<&World::set_pair>(world, "a"_a, "b"_a, "friction"_a, "restitution"_a,
                        "kinetic_friction"_a = py::none());
  def<&World::set_collide>(world, "a"_a, "b"_a, "collide"_a);
  def<py::overload_cast<ObjectId, std::uint64_t>(&World::set_user_data)>(world, "object"_a, "data"_a);
  def<py::overload_cast<ColliderId, std::uint64_t>(&World::set_user_data)>(world, "collider"_a, "data"_a);
  const char* const see = "See set_user_data.";
  def<py::overload_cast<ObjectId>(&World::user_data, py::const_)>(world, "object"_a, see);
  def<py::overload_cast<ColliderId>(&World::user_data, py::const_)>(world, "collider"_a, see);
}

}  // namespace

void bind_world_colliders(WorldClass& world) {
  def_with_options<&World::add_collider>(
      world, "shape"_a, "options"_a = py::none(),
      "Adds a shape that objects collide with. Keywords are members of ColliderOptions.");
  def<py::overload_cast<ColliderId>(&World::remove)>(world, "collider"_a, "Removes a collider.");
  world.def(
      "set_collider",
      [](BoundWorld& self, ColliderId id, const Shape& shape, const std::optional<ColliderOptions>& options,
         const py::kwargs& kwargs) {
        World& used = self.use("set_collider");
        const std::optional before(options.value_or(used.collider_options(id)));
        used.set_collider(id, shape, with_keywords(before, kwargs, "set_collider"));
      },
      "collider"_a, "shape"_a, "options"_a = py::none(),
      "Replaces the shape, and the options or the members of them that keywords name.");
  def<&World::move_collider>(world, "collider"_a, "pose"_a);
  def<&World::colliders>(world, "All colliders, in order of addition.");
  def<&World::shape>(world, "collider"_a, "A copy of the shape of a collider.");
  def<&World::collider_options>(world, "collider"_a, "A copy of the options of a collider.");
  def<&World::collider_pose>(world, "collider"_a);
  def<&World::find_collider>(world, "name"_a,
                             "The collider of this name. Throws Error with the nearest name.");
  bind_flow(world);
  bind_forces(world);
  bind_pairs(world);
}

}  // namespace souple::python
