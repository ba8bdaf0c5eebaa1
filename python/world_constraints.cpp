#include "python/bind.h"
#include "python/bound_world.h"
#include "python/catalogue.h"

namespace souple::python {

namespace {

using Pairs = std::vector<std::pair<VertexRef, VertexRef>>;

void bind_pins(WorldClass& world) {
  world.def(
      "pin",
      [](BoundWorld& self, ObjectId object, const Selector& selector, const py::object& target) {
        self.use("pin").pin(object, selector, target_of(self, target, "target of pin"));
      },
      "object"_a, "selector"_a, "target"_a = py::none(),
      "Fixes vertices at their positions, or drives them along target(vertex, time) -> position [m]. "
      "Forces do not move a pinned vertex.");
  def<&World::unpin>(world, "object"_a, "selector"_a, "Releases pinned vertices.");
  def<&World::pinned>(world, "object"_a, "The pinned vertices of an object.");
  def<py::overload_cast<ObjectId, const Selector&, const Transform&>(&World::move_pins)>(
      world, "object"_a, "selector"_a, "motion"_a);
  def<py::overload_cast<ObjectId, std::span<const std::uint32_t>, std::span<const Vec3f>>(&World::move_pins)>(
      world, "object"_a, "vertices"_a, "positions"_a);
  world.def(
      "attach",
      [](BoundWorld& self, ObjectId object, const Selector& selector, const py::object& target,
         float compliance) {
        return self.use("attach").attach(object, selector, target_of(self, target, "target of attach"),
                                         compliance);
      },
      "object"_a, "selector"_a, "target"_a = py::none(), "compliance"_a = 0, doc("World.attach"));
}

void bind_projectors(WorldClass& world) {
  world
      .def(
          "add_projector",
          [](BoundWorld& self, const ConstraintArrays& constraints) {
            return self.use("add_projector").add_projector(constraints.make());
          },
          "constraints"_a,
          "Adds constraints of a kind of the catalogue, or of your own function: SetProjector, "
          "CustomProjector.")
      .def(
          "add_projector",
          [](BoundWorld& self, const CustomArguments& constraints) {
            return self.use("add_projector").add_projector(constraints.make(self));
          },
          "constraints"_a, "Adds constraints of your own function.");
  def<py::overload_cast<ProjectorId>(&World::remove)>(world, "projector"_a,
                                                      "Removes constraints that were added.");
}

}  // namespace

void bind_world_constraints(WorldClass& world) {
  bind_pins(world);
  world.def(
      "connect",
      [](BoundWorld& self, const Pairs& pairs, float rest_length, float compliance,
         std::optional<double> until) {
        return self.use("connect").connect(pairs, rest_length, compliance, until);
      },
      "pairs"_a, "rest_length"_a = 0, "compliance"_a = 0, "until"_a = py::none(), doc("World.connect"));
  def<&World::add_tethers>(world, "object"_a, "slack"_a = 0.02f);
  def<&World::set_pressure>(world, "object"_a, "pascals"_a);
  def<&World::set_enclosed_volume>(world, "object"_a, "factor"_a, "compliance"_a = 0);
  def<&World::particle>(world, "object"_a, "vertex"_a);
  world.def(
      "particles",
      [](BoundWorld& self, ObjectId object, std::span<const std::uint32_t> vertices) {
        const World& used = self.use("particles");
        std::vector<std::uint32_t> particles;
        particles.reserve(vertices.size());
        for (const std::uint32_t vertex : vertices) particles.push_back(used.particle(object, vertex));
        return particles;
      },
      "object"_a, "vertices"_a, "The particle indices of many vertices, as `particle` gives one.");
  def<&World::carriers>(world, "object"_a, "vertex"_a);
  bind_projectors(world);
}

}  // namespace souple::python
