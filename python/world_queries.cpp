#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/world/debug_draw.h"

namespace souple::python {

namespace {

std::vector<ContactEvent> contacts_of(BoundWorld& world) {
  const std::span<const ContactEvent> events = world.use("contacts").contacts();
  std::vector<ContactEvent> copies(events.begin(), events.end());
  for (ContactEvent& event : copies) {
    event.object = kept_text(event.object);
    event.other = kept_text(event.other);
  }
  return copies;
}

std::vector<ContactPair> contact_pairs_of(BoundWorld& world) {
  const std::span<const ContactPair> pairs = world.use("contact_pairs").contact_pairs();
  return {pairs.begin(), pairs.end()};
}

py::object constraint_of(const DebugConstraint& c) {
  return namespace_of(py::arg("kind") = std::string(c.kind), py::arg("points") = to_array(c.points),
                      py::arg("color") = c.color, py::arg("strain") = c.strain,
                      py::arg("residual") = c.residual);
}

py::object joint_of(const DebugJoint& j) {
  return namespace_of(py::arg("name") = std::string(j.name), py::arg("kind") = std::string(j.kind),
                      py::arg("point_a") = j.point_a, py::arg("point_b") = j.point_b,
                      py::arg("axis") = j.axis, py::arg("rope") = to_array(j.rope), py::arg("taut") = j.taut,
                      py::arg("broken") = j.broken);
}

void debug_draw(BoundWorld& world, const py::object& constraint, const py::object& contact,
                const py::object& particle, const py::object& joint, const py::object& tet_edge) {
  for (const py::object& function : {constraint, contact, particle, joint, tet_edge})
    if (!function.is_none()) require_callable(function, "debug_draw");
  DebugDraw draw;
  if (!constraint.is_none())
    draw.constraint = [&](const DebugConstraint& c) { constraint(constraint_of(c)); };
  if (!contact.is_none()) draw.contact = [&](const DebugContact& c) { contact(c); };
  if (!particle.is_none()) draw.particle = [&](const DebugParticle& p) { particle(p); };
  if (!joint.is_none()) draw.joint = [&](const DebugJoint& j) { joint(joint_of(j)); };
  if (!tet_edge.is_none()) draw.tet_edge = [&](const Vec3f& a, const Vec3f& b) { tet_edge(a, b); };
  world.use("debug_draw").debug_draw(draw);
}

}  // namespace

void bind_world_queries(WorldClass& world) {
  const auto filter = [] { return py::arg_v("filter", QueryFilter{}, "QueryFilter()"); };
  world.def("contacts", &contacts_of, "Contacts of the last step.")
      .def("track_contacts", checked("track_contacts", &World::track_contacts), py::arg("on"),
           doc("World.track_contacts"))
      .def("contact_pairs", &contact_pairs_of, doc("World.contact_pairs"))
      .def("ray_cast", checked("ray_cast", &World::ray_cast), py::arg("origin"), py::arg("direction"),
           py::arg("max_distance") = 1e30, filter(), doc("World.ray_cast"))
      .def("ray_cast_all", checked("ray_cast_all", &World::ray_cast_all), py::arg("origin"),
           py::arg("direction"), py::arg("max_distance") = 1e30, filter(), doc("World.ray_cast_all"))
      .def("sphere_cast", checked("sphere_cast", &World::sphere_cast), py::arg("origin"), py::arg("radius"),
           py::arg("direction"), py::arg("max_distance") = 1e30, filter(), doc("World.sphere_cast"))
      .def("closest_point", checked("closest_point", &World::closest_point), py::arg("point"), filter(),
           doc("World.closest_point"))
      .def("overlap", checked("overlap", &World::overlap), py::arg("shape"),
           py::arg_v("pose", Transform{}, "Transform()"), filter(), doc("World.overlap"))
      .def("debug_draw", &debug_draw, py::arg("constraint") = py::none(), py::arg("contact") = py::none(),
           py::arg("particle") = py::none(), py::arg("joint") = py::none(), py::arg("tet_edge") = py::none(),
           doc("World.debug_draw"));
}

}  // namespace souple::python
