#include "souple/world/debug_draw.h"

#include "souple/geometry/adjacency.h"
#include "souple/objects/joint_options.h"
#include "souple/objects/object.h"
#include "souple/objects/tie_options.h"
#include "souple/rigid/joints/joint.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"
#include "souple/world/world.h"

namespace souple {
namespace {

void draw_constraints(WorldState& world, const std::function<void(const DebugConstraint&)>& draw) {
  if (!world.current.running) bring_constraints_up_to_date(world);
  const ParticleView view = world.view();
  std::vector<Vec3f> points;
  const bool has_contacts = world.contact->valid || world.current.running;
  for (const Projector* projector : has_contacts ? world.constraints.order : world.constraints.lasting()) {
    const std::string_view kind = projector->kind();
    projector->visit(view, [&](const ConstraintState& constraint) {
      points.clear();
      for (const std::uint32_t i : constraint.particles)
        points.push_back(Vec3f(world.particles.exact_position(i)));
      draw({kind, points, constraint.color, constraint.strain, constraint.residual});
    });
  }
}

void draw_particles(const WorldState& world, const std::function<void(const DebugParticle&)>& draw) {
  for (const auto& object : world.objects)
    for (std::uint32_t i = object->begin; i < object->end; ++i) {
      const float w = world.particles.position[i].w;
      draw(
          {Vec3f(world.particles.exact_position(i)), world.particles.radius[i], w, w == 0, object->id.value});
    }
}

void draw_tet_edges(const WorldState& world, const std::function<void(const Vec3f&, const Vec3f&)>& draw) {
  for (const auto& object : world.objects)
    for (const Edge& edge : unique_edges(object->tets.tets))
      draw(Vec3f(world.particles.exact_position(object->begin + edge[0])),
           Vec3f(world.particles.exact_position(object->begin + edge[1])));
}

void draw_joints(const World& world, const std::function<void(const DebugJoint&)>& draw) {
  for (const JointId id : world.joints()) {
    const JointReport report = world.joint_report(id);
    const joint::Kind& kind = world.joint_kind(id);
    const Vec3f a(report.point_a), b(report.point_b);
    std::vector<Vec3f> rope;
    if (std::holds_alternative<joint::Distance>(kind)) rope = {a, b};
    if (const auto* pulley = std::get_if<joint::Pulley>(&kind))
      rope = {a, Vec3f(pulley->wheel_a), Vec3f(pulley->wheel_b), b};
    draw({report.name, joint::kind_name(kind), a, b, Vec3f(report.axis), rope,
          length_squared(report.force) > 0, report.broken});
  }
  for (const TieId id : world.ties()) {
    const TieReport tie = world.tie_report(id);
    const Vec3f a(tie.point_a), b(tie.point_b);
    draw({tie.name, "tie", a, b, {}, {}, length_squared(tie.force) > 0, tie.broken});
  }
}

}  // namespace

void World::debug_draw(const DebugDraw& draw) const {
  WorldState& world = state();
  std::vector<ContactEvent> events;
  if (draw.contact) events.assign(contacts().begin(), contacts().end());
  const CallScope call(*world.calls, "debug_draw", From::stages);
  if (draw.joint) draw_joints(*this, draw.joint);
  if (draw.constraint) draw_constraints(world, draw.constraint);
  for (const ContactEvent& event : events) draw.contact({event.point, event.normal, event.impulse});
  if (draw.particle) {
    if (!world.current.running) bring_constraints_up_to_date(world);  // and the radii
    draw_particles(world, draw.particle);
  }
  if (draw.tet_edge) draw_tet_edges(world, draw.tet_edge);
}

}  // namespace souple
