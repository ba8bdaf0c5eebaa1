#include "python/bind.h"
#include "python/bound_world.h"

namespace souple::python {

namespace {

void bind_changes(WorldClass& world) {
  world
      .def("set_positions", checked("set_positions", &World::set_positions), py::arg("object"),
           py::arg("positions"), doc("World.set_positions"))
      .def("set_velocities", checked("set_velocities", &World::set_velocities), py::arg("object"),
           py::arg("velocities"), "Sets the velocities of all vertices, in user order [m/s].")
      .def("set_angular_velocities", checked("set_angular_velocities", &World::set_angular_velocities),
           py::arg("grains"), py::arg("angular_velocities"), doc("World.set_angular_velocities"))
      .def("teleport", checked("teleport", &World::teleport), py::arg("object"), py::arg("transform"),
           doc("World.teleport"))
      .def("apply_impulse",
           checked<void, ObjectId, const Selector&, const Vec3f&>("apply_impulse", &World::apply_impulse),
           py::arg("object"), py::arg("selector"), py::arg("impulse"), doc("World.apply_impulse"))
      .def("apply_impulse",
           checked<void, ObjectId, const Vec3f&, const Vec3f&>("apply_impulse", &World::apply_impulse),
           py::arg("body"), py::arg("impulse"), py::arg("point"), doc("World.apply_impulse"))
      .def("apply_angular_impulse", checked("apply_angular_impulse", &World::apply_angular_impulse),
           py::arg("body"), py::arg("impulse"), doc("World.apply_angular_impulse"))
      .def("is_asleep", checked("is_asleep", &World::is_asleep), py::arg("object"),
           "Whether an object sleeps.")
      .def("wake", checked("wake", &World::wake), py::arg("object"), doc("World.wake"));
}

void bind_sums(WorldClass& world) {
  world
      .def("total_mass", checked("total_mass", &World::total_mass), py::arg("object"),
           doc("World.total_mass"))
      .def("kinetic_energy", checked("kinetic_energy", &World::kinetic_energy), py::arg("object"),
           doc("World.kinetic_energy"))
      .def("potential_energy", checked("potential_energy", &World::potential_energy), py::arg("object"),
           doc("World.potential_energy"))
      .def("elastic_energy", checked("elastic_energy", &World::elastic_energy), doc("World.elastic_energy"))
      .def("unconverged_energy", checked("unconverged_energy", &World::unconverged_energy), py::arg("dt"),
           doc("World.unconverged_energy"))
      .def("momentum", checked("momentum", &World::momentum), py::arg("object"), doc("World.momentum"))
      .def("center_of_mass", checked("center_of_mass", &World::center_of_mass), py::arg("object"),
           doc("World.center_of_mass"))
      .def("tet_statistics", checked("tet_statistics", &World::tet_statistics), py::arg("object"),
           "Size of the tet mesh of a soft body; zeros for other kinds.")
      .def("particle_radius", checked<float, ObjectId>("particle_radius", &World::particle_radius),
           py::arg("object"), doc("World.particle_radius"))
      .def("count_crossings", checked("count_crossings", &World::count_crossings), py::arg("object"),
           doc("World.count_crossings"));
}

Snapshot snapshot_of(const py::bytes& bytes) {
  const auto text = static_cast<std::string_view>(bytes);
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return {std::vector<std::byte>(begin, begin + text.size())};
}

void bind_snapshots(WorldClass& world) {
  world
      .def(
          "snapshot",
          [](BoundWorld& self) {
            const Snapshot snapshot = self.use("snapshot").snapshot();
            return py::bytes(reinterpret_cast<const char*>(snapshot.bytes.data()), snapshot.bytes.size());
          },
          doc("World.snapshot"))
      .def(
          "restore",
          [](BoundWorld& self, const py::bytes& bytes) { self.use("restore").restore(snapshot_of(bytes)); },
          py::arg("snapshot"), doc("World.restore"))
      .def("hash", checked("hash", &World::hash), doc("World.hash"))
      .def("version", checked("version", &World::version), doc("World.version"));
}

}  // namespace

void bind_world_state(WorldClass& world) {
  bind_changes(world);
  bind_sums(world);
  bind_snapshots(world);
  world.def("mesh", checked("mesh", &World::mesh), py::arg("object"), doc("World.mesh"))
      .def(
          "foam",
          [](BoundWorld& self) {
            const FoamView view = self.use("foam").foam();
            const auto kinds = copied_array(view.kinds.data(), view.kinds.size(), "u1", 0);
            return namespace_of(py::arg("positions") = to_array(view.positions),
                                py::arg("velocities") = to_array(view.velocities), py::arg("kinds") = kinds);
          },
          doc("World.foam"))
      .def("pressures", checked("pressures", &World::pressures), py::arg("fluid"), doc("World.pressures"))
      .def("select", checked("select", &World::select), py::arg("object"), py::arg("selector"),
           doc("World.select"));
}

}  // namespace souple::python
