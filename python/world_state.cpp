#include "python/bind.h"
#include "python/bound_world.h"

namespace souple::python {

namespace {

void bind_changes(WorldClass& world) {
  def<&World::set_positions>(world, "object"_a, "positions"_a);
  def<&World::set_velocities>(world, "object"_a, "velocities"_a,
                              "Sets the velocities of all vertices, in user order [m/s].");
  def<&World::set_angular_velocities>(world, "grains"_a, "angular_velocities"_a);
  def<&World::teleport>(world, "object"_a, "transform"_a);
  def<py::overload_cast<ObjectId, const Selector&, const Vec3f&>(&World::apply_impulse)>(
      world, "object"_a, "selector"_a, "impulse"_a);
  def<py::overload_cast<ObjectId, const Vec3f&, const Vec3f&>(&World::apply_impulse)>(world, "body"_a,
                                                                                      "impulse"_a, "point"_a);
  def<&World::apply_angular_impulse>(world, "body"_a, "impulse"_a);
  def<&World::is_asleep>(world, "object"_a, "Whether an object sleeps.");
  def<&World::wake>(world, "object"_a);
}

void bind_sums(WorldClass& world) {
  def<&World::total_mass>(world, "object"_a);
  def<&World::kinetic_energy>(world, "object"_a);
  def<&World::potential_energy>(world, "object"_a);
  def<&World::elastic_energy>(world);
  def<&World::unconverged_energy>(world, "dt"_a);
  def<&World::momentum>(world, "object"_a);
  def<&World::center_of_mass>(world, "object"_a);
  def<&World::tet_statistics>(world, "object"_a,
                              "Size of the tet mesh of a soft body; zeros for other kinds.");
  def<py::overload_cast<ObjectId>(&World::particle_radius, py::const_)>(world, "object"_a);
  def<&World::count_crossings>(world, "object"_a);
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
          "snapshot"_a, doc("World.restore"));
  def<&World::hash>(world);
  def<&World::version>(world);
}

}  // namespace

void bind_world_state(WorldClass& world) {
  bind_changes(world);
  bind_sums(world);
  bind_snapshots(world);
  def<&World::mesh>(world, "object"_a);
  world.def(
      "foam",
      [](BoundWorld& self) {
        const FoamView view = self.use("foam").foam();
        const auto kinds = copied_array(view.kinds.data(), view.kinds.size(), "u1", 0);
        return namespace_of("positions"_a = to_array(view.positions),
                            "velocities"_a = to_array(view.velocities), "kinds"_a = kinds);
      },
      doc("World.foam"));
  def<&World::pressures>(world, "fluid"_a);
  def<&World::select>(world, "object"_a, "selector"_a);
}

}  // namespace souple::python
