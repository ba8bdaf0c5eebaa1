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

template <class Report>
Report kept(Report report) {
  report.name = kept_text(report.name);
  return report;
}

void bind_joints_of(WorldClass& world) {
  world
      .def(
          "add_joint",
          [](BoundWorld& self, const JointEnd& a, const JointEnd& b, const JointKind& kind,
             const std::optional<JointOptions>& options, const py::kwargs& kwargs) {
            World& used = self.use("add_joint");
            return used.add_joint(side_of(a), side_of(b), kind_of(kind),
                                  with_keywords(options, kwargs, "add_joint"));
          },
          "a"_a, "b"_a, "kind"_a, "options"_a = py::none(), doc("World.add_joint"))
      .def(
          "set_joint",
          [](BoundWorld& self, JointId id, const JointKind& kind) {
            self.use("set_joint").set_joint(id, kind_of(kind));
          },
          "joint"_a, "kind"_a, doc("World.set_joint"))
      .def(
          "joint_kind",
          [](BoundWorld& self, JointId id) -> JointKind {
            return std::visit(
                [](const auto& joint) { return JointKind(joint); },
                static_cast<const joint::Kind::variant&>(self.use("joint_kind").joint_kind(id)));
          },
          "joint"_a, "A copy of what a joint is; set_joint changes it.")
      .def(
          "joint_report",
          [](BoundWorld& self, JointId id) { return kept(self.use("joint_report").joint_report(id)); },
          "joint"_a, "How a joint is, and what it does.");
  def<py::overload_cast<JointId>(&World::remove)>(world, "joint"_a, "Removes a joint.");
  def<&World::joints>(world);
  def<&World::find_joint>(world, "name"_a);
}

}  // namespace

void bind_world_joints(WorldClass& world) {
  bind_joints_of(world);
  world
      .def(
          "add_tie",
          [](BoundWorld& self, const TieEnd& a, const TieEnd& b, const std::optional<TieOptions>& options,
             const py::kwargs& kwargs) {
            World& used = self.use("add_tie");
            return used.add_tie(side_of(a), side_of(b), with_keywords(options, kwargs, "add_tie"));
          },
          "a"_a, "b"_a, "options"_a = py::none(), doc("World.add_tie"))
      .def(
          "tie_report",
          [](BoundWorld& self, TieId id) { return kept(self.use("tie_report").tie_report(id)); }, "tie"_a,
          "How a tie is, and what it does.");
  def_with_options<&World::stitch>(world, "a"_a, "vertices"_a, "b"_a, "distance"_a, "options"_a = py::none());
  def<py::overload_cast<TieId>(&World::remove)>(world, "tie"_a, "Removes a tie.");
  def<&World::ties>(world);
  def<&World::surface_point>(world, "object"_a, "point"_a);
}

}  // namespace souple::python
