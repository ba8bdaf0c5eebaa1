#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/objects/joint_options.h"
#include "souple/objects/tie_options.h"
#include "souple/rigid/joints/joint.h"

namespace souple::python {

namespace {

/// One side of a joint or tie: None is the world.
using JointEnd = std::variant<std::monostate, ObjectId, ColliderId>;
using TieEnd = std::variant<std::monostate, ObjectId, SurfacePoint, ColliderId>;
using JointKind = std::variant<joint::Fixed, joint::Ball, joint::Hinge, joint::Slider, joint::Universal,
                               joint::Distance, joint::Pulley>;

JointSide side_of(const JointEnd& end) {
  if (const auto* const object = std::get_if<ObjectId>(&end)) return {*object};
  if (const auto* const collider = std::get_if<ColliderId>(&end)) return {*collider};
  return {};
}

TieSide side_of(const TieEnd& end) {
  if (const auto* const object = std::get_if<ObjectId>(&end)) return {*object};
  if (const auto* const point = std::get_if<SurfacePoint>(&end)) return {*point};
  if (const auto* const collider = std::get_if<ColliderId>(&end)) return {*collider};
  return {};
}

joint::Kind kind_of(const JointKind& kind) {
  return std::visit([](const auto& joint) { return joint::Kind(joint); }, kind);
}

void bind_joints_of(WorldClass& world) {
  world
      .def(
          "add_joint",
          [](BoundWorld& self, const JointEnd& a, const JointEnd& b, const JointKind& kind,
             const std::optional<JointOptions>& options, const py::kwargs& kwargs) {
            return self.use("add_joint")
                .add_joint(side_of(a), side_of(b), kind_of(kind),
                           with_keywords(options, kwargs, "add_joint"));
          },
          py::arg("a"), py::arg("b"), py::arg("kind"), py::arg("options") = py::none(),
          doc("World.add_joint"))
      .def("remove", checked<void, JointId>("remove", &World::remove), py::arg("joint"), "Removes a joint.")
      .def(
          "set_joint",
          [](BoundWorld& self, JointId id, const JointKind& kind) {
            self.use("set_joint").set_joint(id, kind_of(kind));
          },
          py::arg("joint"), py::arg("kind"), doc("World.set_joint"))
      .def(
          "joint_kind",
          [](BoundWorld& self, JointId id) -> JointKind {
            return std::visit(
                [](const auto& joint) { return JointKind(joint); },
                static_cast<const joint::Kind::variant&>(self.use("joint_kind").joint_kind(id)));
          },
          py::arg("joint"), "A copy of what a joint is; set_joint changes it.")
      .def(
          "joint_report",
          [](BoundWorld& self, JointId id) {
            JointReport report = self.use("joint_report").joint_report(id);
            report.name = kept_text(report.name);
            return report;
          },
          py::arg("joint"), "How a joint is, and what it does.")
      .def("joints", checked("joints", &World::joints), doc("World.joints"))
      .def("find_joint", checked("find_joint", &World::find_joint), py::arg("name"), doc("World.find_joint"));
}

}  // namespace

void bind_world_joints(WorldClass& world) {
  bind_joints_of(world);
  world
      .def(
          "add_tie",
          [](BoundWorld& self, const TieEnd& a, const TieEnd& b, const std::optional<TieOptions>& options,
             const py::kwargs& kwargs) {
            return self.use("add_tie").add_tie(side_of(a), side_of(b),
                                               with_keywords(options, kwargs, "add_tie"));
          },
          py::arg("a"), py::arg("b"), py::arg("options") = py::none(), doc("World.add_tie"))
      .def(
          "stitch",
          [](BoundWorld& self, ObjectId a, const Selector& vertices, ObjectId b, double distance,
             const std::optional<TieOptions>& options, const py::kwargs& kwargs) {
            return self.use("stitch").stitch(a, vertices, b, distance,
                                             with_keywords(options, kwargs, "stitch"));
          },
          py::arg("a"), py::arg("vertices"), py::arg("b"), py::arg("distance"),
          py::arg("options") = py::none(), doc("World.stitch"))
      .def("remove", checked<void, TieId>("remove", &World::remove), py::arg("tie"), "Removes a tie.")
      .def(
          "tie_report",
          [](BoundWorld& self, TieId id) {
            TieReport report = self.use("tie_report").tie_report(id);
            report.name = kept_text(report.name);
            return report;
          },
          py::arg("tie"), "How a tie is, and what it does.")
      .def("ties", checked("ties", &World::ties), doc("World.ties"))
      .def("surface_point", checked("surface_point", &World::surface_point), py::arg("object"),
           py::arg("point"), doc("World.surface_point"));
}

}  // namespace souple::python
