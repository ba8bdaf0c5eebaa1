#include "python/bind.h"
#include "python/bound_world.h"
#include "python/catalogue.h"

namespace souple::python {

namespace {

using Pairs = std::vector<std::pair<VertexRef, VertexRef>>;

void bind_pins(WorldClass& world) {
  world
      .def(
          "pin",
          [](BoundWorld& self, ObjectId object, const Selector& selector, const py::object& target) {
            self.use("pin").pin(object, selector, target_of(self, target, "target of pin"));
          },
          py::arg("object"), py::arg("selector"), py::arg("target") = py::none(),
          "Fixes vertices at their positions, or drives them along target(vertex, time) -> position [m]. "
          "Forces do not move a "
          "pinned vertex.")
      .def("unpin", checked("unpin", &World::unpin), py::arg("object"), py::arg("selector"),
           "Releases pinned vertices.")
      .def("pinned", checked("pinned", &World::pinned), py::arg("object"),
           "The pinned vertices of an object.")
      .def("move_pins",
           checked<void, ObjectId, const Selector&, const Transform&>("move_pins", &World::move_pins),
           py::arg("object"), py::arg("selector"), py::arg("motion"), doc("World.move_pins"))
      .def("move_pins",
           checked<void, ObjectId, std::span<const std::uint32_t>, std::span<const Vec3f>>("move_pins",
                                                                                           &World::move_pins),
           py::arg("object"), py::arg("vertices"), py::arg("positions"), doc("World.move_pins"))
      .def(
          "attach",
          [](BoundWorld& self, ObjectId object, const Selector& selector, const py::object& target,
             float compliance) {
            return self.use("attach").attach(object, selector, target_of(self, target, "target of attach"),
                                             compliance);
          },
          py::arg("object"), py::arg("selector"), py::arg("target") = py::none(), py::arg("compliance") = 0,
          doc("World.attach"));
}

}  // namespace

void bind_world_constraints(WorldClass& world) {
  bind_pins(world);
  world
      .def(
          "connect",
          [](BoundWorld& self, const Pairs& pairs, float rest_length, float compliance,
             std::optional<double> until) {
            return self.use("connect").connect(pairs, rest_length, compliance, until);
          },
          py::arg("pairs"), py::arg("rest_length") = 0, py::arg("compliance") = 0,
          py::arg("until") = py::none(), doc("World.connect"))
      .def("add_tethers", checked("add_tethers", &World::add_tethers), py::arg("object"),
           py::arg("slack") = 0.02f, doc("World.add_tethers"))
      .def("set_pressure", checked("set_pressure", &World::set_pressure), py::arg("object"),
           py::arg("pascals"), doc("World.set_pressure"))
      .def("set_enclosed_volume", checked("set_enclosed_volume", &World::set_enclosed_volume),
           py::arg("object"), py::arg("factor"), py::arg("compliance") = 0, doc("World.set_enclosed_volume"))
      .def("particle", checked("particle", &World::particle), py::arg("object"), py::arg("vertex"),
           doc("World.particle"))
      .def(
          "particles",
          [](BoundWorld& self, ObjectId object, std::span<const std::uint32_t> vertices) {
            const World& used = self.use("particles");
            std::vector<std::uint32_t> particles;
            particles.reserve(vertices.size());
            for (const std::uint32_t vertex : vertices) particles.push_back(used.particle(object, vertex));
            return particles;
          },
          py::arg("object"), py::arg("vertices"),
          "The particle indices of many vertices, as `particle` gives one.")
      .def("carriers", checked("carriers", &World::carriers), py::arg("object"), py::arg("vertex"),
           doc("World.carriers"))
      .def(
          "add_projector",
          [](BoundWorld& self, const ConstraintArrays& constraints) {
            return self.use("add_projector").add_projector(constraints.make());
          },
          py::arg("constraints"),
          "Adds constraints of a kind of the catalogue, or of your own function: SetProjector, "
          "CustomProjector.")
      .def(
          "add_projector",
          [](BoundWorld& self, const CustomArguments& constraints) {
            return self.use("add_projector").add_projector(constraints.make(self));
          },
          py::arg("constraints"), "Adds constraints of your own function.")
      .def("remove", checked<void, ProjectorId>("remove", &World::remove), py::arg("projector"),
           "Removes constraints that were added.");
}

}  // namespace souple::python
