#include "souple/world/body_restitution.h"

#include "souple/objects/contact_geometry.h"
#include "souple/objects/object.h"
#include "souple/world/contact_state.h"
#include "souple/world/step_scratch.h"

#include <utility>

namespace souple {
namespace {

// A body with pinned particles, or asleep, does not move as a whole: its mass is 0.
BodyAtImpact measure(const WorldState& world, std::uint32_t index) {
  const Object& object = *world.objects[index];
  BodyAtImpact body{index};
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const float w = world.particles.position[i].w;
    if (!(w > 0)) return {index};
    const double m = 1 / static_cast<double>(w);
    body.mass += m;
    body.velocity += Vec3d(world.particles.velocity[i].xyz()) * m;
  }
  body.velocity = body.velocity / body.mass;
  return body;
}

BodyAtImpact& body_at(WorldState& world, std::uint32_t particle) {
  const std::uint32_t index = world.object_of[particle];
  for (BodyAtImpact& body : world.scratch->bodies_at_impact)
    if (body.object == index) return body;
  return world.scratch->bodies_at_impact.emplace_back(measure(world, index));
}

// Index of the body in world.scratch->bodies_at_impact, as the list grows.
std::size_t index_of(WorldState& world, std::uint32_t particle) {
  return static_cast<std::size_t>(&body_at(world, particle) - world.scratch->bodies_at_impact.data());
}

// J = (e a - u_n) / (1/M_0 + 1/M_1) along the normal, where the bodies approach.
void solve_impact(WorldState& world, const Impact& impact, double threshold) {
  const Vec3d n(impact.normal);
  const std::size_t one = index_of(world, impact.particle);
  const bool against_body = impact.other != Impact::collider && world.particles.position[impact.other].w > 0;
  const std::size_t other = against_body ? index_of(world, impact.other) : one;
  BodyAtImpact& a = world.scratch->bodies_at_impact[one];
  BodyAtImpact& b = world.scratch->bodies_at_impact[other];
  const double w_a = a.mass > 0 ? 1 / a.mass : 0, w_b = against_body && b.mass > 0 ? 1 / b.mass : 0;
  if (!(w_a + w_b > 0)) return;
  Vec3d fixed(impact.surface_velocity);
  if (impact.other != Impact::collider) fixed = Vec3d(world.particles.velocity[impact.other].xyz());
  const double before = dot(n, a.velocity - (against_body ? b.velocity : fixed));
  if (!(before < -threshold)) return;
  const double u = before + dot(n, a.change - (against_body ? b.change : Vec3d{}));
  const double gained = static_cast<double>(impact.restitution) * static_cast<double>(impact.approach) - u;
  if (!(gained > 0)) return;
  a.change += n * (gained * w_a / (w_a + w_b));
  b.change -= n * (gained * w_b / (w_a + w_b));
}

bool is_soft_body(const WorldState& world, std::uint32_t particle) {
  return world.objects[world.object_of[particle]]->traits().shape == ObjectShape::solid;
}

// Both sides are soft bodies, or one is a soft body and the other cannot move. The first side becomes a soft body.
bool concerns_bodies(const WorldState& world, Impact& impact) {
  if (!(impact.restitution > elastic_restitution)) return false;
  if (impact.other == Impact::collider) return is_soft_body(world, impact.particle);
  if (!is_soft_body(world, impact.particle)) {
    std::swap(impact.particle, impact.other);
    impact.normal = -impact.normal;
  }
  const bool fixed = !(world.particles.position[impact.other].w > 0);
  return is_soft_body(world, impact.particle) && (fixed || is_soft_body(world, impact.other));
}

}  // namespace

void restitute_bodies(WorldState& world, const Substep& substep) {
  world.scratch->impacts.clear();
  world.scratch->bodies_at_impact.clear();
  world.contact->contacts.append_impacts(substep, world.scratch->impacts);
  const double threshold = 2 * static_cast<double>(length(world.settings.gravity) * substep.h);
  for (Impact& impact : world.scratch->impacts)
    if (concerns_bodies(world, impact)) solve_impact(world, impact, threshold);
  for (const BodyAtImpact& body : world.scratch->bodies_at_impact) {
    const Object& object = *world.objects[body.object];
    for (std::uint32_t i = object.begin; body.mass > 0 && i < object.end; ++i) {
      Vec4f& velocity = world.particles.velocity[i];
      velocity.set_xyz(velocity.xyz() + Vec3f(body.change));
    }
  }
}

}  // namespace souple
