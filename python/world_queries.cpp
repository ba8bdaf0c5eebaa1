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
  return namespace_of("kind"_a = std::string(c.kind), "points"_a = to_array(c.points), "color"_a = c.color,
                      "strain"_a = c.strain, "residual"_a = c.residual);
}

py::object joint_of(const DebugJoint& j) {
  return namespace_of("name"_a = std::string(j.name), "kind"_a = std::string(j.kind), "point_a"_a = j.point_a,
                      "point_b"_a = j.point_b, "axis"_a = j.axis, "rope"_a = to_array(j.rope),
                      "taut"_a = j.taut, "broken"_a = j.broken);
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
  const py::arg_v filter = with_default<QueryFilter>("filter"), distance("max_distance", 1e30);
  world.def("contacts", &contacts_of, "Contacts of the last step.");
  def<&World::track_contacts>(world, "on"_a);
  world.def("contact_pairs", &contact_pairs_of, doc("World.contact_pairs"));
  def<&World::ray_cast>(world, "origin"_a, "direction"_a, distance, filter);
  def<&World::ray_cast_all>(world, "origin"_a, "direction"_a, distance, filter);
  def<&World::sphere_cast>(world, "origin"_a, "radius"_a, "direction"_a, distance, filter);
  def<&World::closest_point>(world, "point"_a, filter);
  def<&World::overlap>(world, "shape"_a, with_default<Transform>("pose"), filter);
  world.def("debug_draw", &debug_draw, "constraint"_a = py::none(), "contact"_a = py::none(),
            "particle"_a = py::none(), "joint"_a = py::none(), "tet_edge"_a = py::none(),
            doc("World.debug_draw"));
}

}  // namespace souple::python
