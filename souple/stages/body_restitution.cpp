#include "souple/stages/body_restitution.h"

#include "souple/contacts/contacts.h"
#include "souple/objects/contact_geometry.h"
#include "souple/objects/object.h"

#include <utility>

namespace souple {
namespace {

// A body with pinned particles, or asleep, does not move as a whole: its mass is 0.
BodyAtImpact measure(const ObjectsView& objects, std::uint32_t index) {
  const Object& object = *objects.objects[index];
  BodyAtImpact body{index};
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const float w = objects.particles.position[i].w;
    if (!(w > 0)) return {index};
    const double m = 1 / static_cast<double>(w);
    body.mass += m;
    body.velocity += Vec3d(objects.particles.velocity[i].xyz()) * m;
  }
  body.velocity = body.velocity / body.mass;
  return body;
}

// Index of the particle's body in `bodies`, which grows.
std::size_t index_of(const ObjectsView& objects, std::uint32_t particle, std::vector<BodyAtImpact>& bodies) {
  const std::uint32_t object = objects.object_of[particle];
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (bodies[k].object == object) return k;
  bodies.push_back(measure(objects, object));
  return bodies.size() - 1;
}

// J = (e a - u_n) / (1/M_0 + 1/M_1) along the normal, where the bodies approach.
void solve_impact(const ObjectsView& objects, const Impact& impact, double threshold,
                  std::vector<BodyAtImpact>& bodies) {
  const Vec3d n(impact.normal);
  const std::size_t one = index_of(objects, impact.particle, bodies);
  const bool against_body =
      impact.other != Impact::collider && objects.particles.position[impact.other].w > 0;
  const std::size_t other = against_body ? index_of(objects, impact.other, bodies) : one;
  BodyAtImpact& a = bodies[one];
  BodyAtImpact& b = bodies[other];
  const double w_a = a.mass > 0 ? 1 / a.mass : 0, w_b = against_body && b.mass > 0 ? 1 / b.mass : 0;
  if (!(w_a + w_b > 0)) return;
  Vec3d fixed(impact.surface_velocity);
  if (impact.other != Impact::collider) fixed = Vec3d(objects.particles.velocity[impact.other].xyz());
  const double before = dot(n, a.velocity - (against_body ? b.velocity : fixed));
  if (!(before < -threshold)) return;
  const double u = before + dot(n, a.change - (against_body ? b.change : Vec3d{}));
  const double gained = static_cast<double>(impact.restitution) * static_cast<double>(impact.approach) - u;
  if (!(gained > 0)) return;
  a.change += n * (gained * w_a / (w_a + w_b));
  b.change -= n * (gained * w_b / (w_a + w_b));
}

bool is_soft_body(const ObjectsView& objects, std::uint32_t particle) {
  return objects.objects[objects.object_of[particle]]->traits().shape == ObjectShape::solid;
}

// Both sides are soft bodies, or one is a soft body and the other cannot move. The first side becomes a soft body.
bool concerns_bodies(const ObjectsView& objects, Impact& impact) {
  if (!(impact.restitution > elastic_restitution)) return false;
  if (impact.other == Impact::collider) return is_soft_body(objects, impact.particle);
  if (!is_soft_body(objects, impact.particle)) {
    std::swap(impact.particle, impact.other);
    impact.normal = -impact.normal;
  }
  const bool fixed = !(objects.particles.position[impact.other].w > 0);
  return is_soft_body(objects, impact.particle) && (fixed || is_soft_body(objects, impact.other));
}

}  // namespace

void restitute_bodies(const ObjectsView& objects, const Contacts& contacts, float gravity,
                      const Substep& substep, BodyImpacts& scratch) {
  scratch.impacts.clear();
  scratch.bodies.clear();
  contacts.append_impacts(substep, scratch.impacts);
  const double threshold = 2 * static_cast<double>(gravity * substep.h);
  for (Impact& impact : scratch.impacts)
    if (concerns_bodies(objects, impact)) solve_impact(objects, impact, threshold, scratch.bodies);
  for (const BodyAtImpact& body : scratch.bodies) {
    const Object& object = *objects.objects[body.object];
    for (std::uint32_t i = object.begin; body.mass > 0 && i < object.end; ++i) {
      Vec4f& velocity = objects.particles.velocity[i];
      velocity.set_xyz(velocity.xyz() + Vec3f(body.change));
    }
  }
}

}  // namespace souple
