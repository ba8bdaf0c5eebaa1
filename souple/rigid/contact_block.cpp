#include "souple/rigid/contact_block.h"

namespace souple {
namespace {

Vec3d world_point(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& local) {
  return body == no_body ? local : poses[body].point(local);
}
Vec3d world_direction(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& local) {
  return body == no_body ? local : poses[body].direction(local);
}
Vec3d local_point(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& world) {
  return body == no_body ? world : poses[body].local_point(world);
}

/// Distance by which the two anchors of friction have slid apart.
Vec3d slip_at(const RigidContact& contact, const RigidContactPoint& point, std::span<const BodyPose> poses) {
  return world_point(poses, contact.a, point.anchor_a) - world_point(poses, contact.b, point.anchor_b);
}

// Softness of a contact, as a part of the inverse mass at its point. A spring of this softness swings in a fifth of a
// substep, and implicit Euler damps such a swing at once. The softness lets the four corners of a box share its weight
// although rounding makes their gaps unequal. A box of any size and mass sinks by 2.5e-8 m under its own weight.
constexpr double softness = 1e-3;

/// An axis normal to n.
Vec3d any_tangent(const Vec3d& n) {
  const Vec3d axis = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalized(tangential(axis, n));
}

/// s J M^-1 J^T t of a point [1/kg].
double inverse_mass_along(const ContactRow& row, const ContactBody& a, const ContactBody& b, const Vec3d& s,
                          const Vec3d& t) {
  return (a.inverse_mass + b.inverse_mass) * dot(s, t) +
         dot(cross(row.r_a, s), a.spin_of(cross(row.r_a, t))) +
         dot(cross(row.r_b, s), b.spin_of(cross(row.r_b, t)));
}

void find_masses(ContactRow& row, const ContactBlock& block, const ContactBody& a, const ContactBody& b) {
  const auto& [n, s, t] = block.axes;
  const double k = inverse_mass_along(row, a, b, n, n), ss = inverse_mass_along(row, a, b, s, s);
  const double st = inverse_mass_along(row, a, b, s, t), tt = inverse_mass_along(row, a, b, t, t);
  row.normal_softness = k * softness, row.tangent_softness = (ss + tt) * softness;
  row.normal_mass = 1 / (k + row.normal_softness);
  const double S = ss + row.tangent_softness, T = tt + row.tangent_softness, d = 1 / (S * T - st * st);
  row.mass_00 = T * d, row.mass_01 = -st * d, row.mass_11 = S * d;
  const double half = (S - T) / 2;
  row.sliding_mass = 1 / ((S + T) / 2 + std::sqrt(half * half + st * st));
}

}  // namespace

PlacedContact place(const RigidContact& contact, const RigidContactPoint& point,
                    std::span<const BodyPose> poses) {
  const Vec3d core_a = world_point(poses, contact.a, point.core_a);
  const Vec3d core_b = world_point(poses, contact.b, point.core_b);
  Vec3d n =
      world_direction(poses, contact.owner == NormalOwner::face_of_b ? contact.b : contact.a, contact.normal);
  if (contact.normal_between_points) {
    const Vec3d between = normalized(core_a - core_b);
    if (length_squared(between) > 0) n = between;
  }
  const Vec3d x_a = core_a - n * contact.radius_a, x_b = core_b + n * contact.radius_b;
  const double C = dot(n, x_a - x_b);
  // When sides slide, the stored point of a face stays behind. So the corner of the other side shows where they touch.
  const Vec3d from_a = x_a - n * (C / 2), from_b = x_b + n * (C / 2);
  switch (contact.owner) {
    case NormalOwner::face_of_a:
      return {n, from_b, C};
    case NormalOwner::face_of_b:
      return {n, from_a, C};
    case NormalOwner::edges:
      break;
  }
  return {n, (from_a + from_b) * 0.5, C};
}

void start_block(RigidContact& contact, ContactBlock& block, const RigidBodies& bodies,
                 std::span<const ContactBody> states, const Depenetration& depenetration) {
  const auto none = static_cast<std::uint32_t>(bodies.size());
  block.a = contact.a == no_body ? none : contact.a, block.b = contact.b == no_body ? none : contact.b;
  block.moves_a = moves(bodies, contact.a), block.moves_b = moves(bodies, contact.b);
  block.static_friction = static_cast<double>(contact.material.static_friction);
  block.kinetic_friction = static_cast<double>(contact.material.kinetic_friction);
  block.count = contact.count;
  for (std::uint32_t k = 0; k < contact.count; ++k) {
    RigidContactPoint& point = contact.points[k];
    const PlacedContact at = place(contact, point, bodies.start);
    if (k == 0) {
      const Vec3d tangent = any_tangent(at.n);
      block.axes = {at.n, tangent, cross(at.n, tangent)};
    }
    if (!point.anchored || point.slid || contact.radius_a + contact.radius_b > 0) {
      point.anchor_a = local_point(bodies.start, contact.a, at.x);
      point.anchor_b = local_point(bodies.start, contact.b, at.x);
      point.anchored = true, point.slid = false;
    }
    ContactRow& row = block.rows[k];
    row.r_a = at.x - center_of(bodies.start, contact.a), row.r_b = at.x - center_of(bodies.start, contact.b);
    find_masses(row, block, states[block.a], states[block.b]);
    const ContactVector tangent = block.along_axes(point.tangent_impulse);
    row.impulse = {point.normal_impulse, tangent[1], tangent[2]};
    // An overlap beyond the compression by the impulses is older than this substep.
    const double overlap = max(-(at.C + row.normal_softness * row.impulse[0]), 0.0);
    const ContactVector slip = block.along_axes(slip_at(contact, point, bodies.start));
    row.ignored = {overlap - min(overlap * depenetration.part, depenetration.largest),
                   -(slip[1] + row.tangent_softness * row.impulse[1]) * (1 - depenetration.part),
                   -(slip[2] + row.tangent_softness * row.impulse[2]) * (1 - depenetration.part)};
  }
}

void measure_block(const RigidContact& contact, ContactBlock& block, const RigidBodies& bodies,
                   std::span<const ContactBody> states) {
  const ContactBody &a = states[block.a], &b = states[block.b];
  for (std::uint32_t k = 0; k < block.count; ++k) {
    ContactRow& row = block.rows[k];
    const RigidContactPoint& point = contact.points[k];
    const ContactVector slip = block.along_axes(slip_at(contact, point, bodies.pose));
    const ContactVector u = block.along_axes(a.motion_at(row.r_a) - b.motion_at(row.r_b));
    const double C = place(contact, point, bodies.pose).C;
    row.gap = {C + row.ignored[0] - u[0], slip[1] + row.ignored[1] - u[1], slip[2] + row.ignored[2] - u[2]};
  }
}

double sweep_block(ContactBlock& block, std::span<ContactBody> states) {
  ContactBody a = states[block.a], b = states[block.b];
  double change = 0;
  for (std::uint32_t k = 0; k < block.count; ++k) {
    ContactRow& row = block.rows[k];
    const auto& [n, s, t] = block.axes;
    const ContactVector last = row.impulse;
    const double C =
        row.gap[0] + dot(n, a.motion_at(row.r_a) - b.motion_at(row.r_b)) + row.normal_softness * last[0];
    const double normal = max(last[0] - C * row.normal_mass, 0.0);
    if (normal == 0 && last[0] == 0) continue;
    const Vec3d push = n * (normal - last[0]);
    a.push(row.r_a, push), b.push(row.r_b, -push);
    const Vec3d u = a.motion_at(row.r_a) - b.motion_at(row.r_b);
    const double slip_s = row.gap[1] + dot(s, u) + row.tangent_softness * last[1];
    const double slip_t = row.gap[2] + dot(t, u) + row.tangent_softness * last[2];
    const ContactVector sticking{normal, last[1] - (row.mass_00 * slip_s + row.mass_01 * slip_t),
                                 last[2] - (row.mass_01 * slip_s + row.mass_11 * slip_t)};
    row.impulse = block.within_limits(sticking);
    // Friction of a sliding contact is opposite to its motion, not to the impulse that would stop it.
    if (row.impulse[1] != sticking[1] || row.impulse[2] != sticking[2])
      row.impulse = block.within_limits(
          {normal, last[1] - row.sliding_mass * slip_s, last[2] - row.sliding_mass * slip_t});
    const double ds = row.impulse[1] - last[1], dt = row.impulse[2] - last[2];
    const Vec3d drag = s * ds + t * dt;
    a.push(row.r_a, drag), b.push(row.r_b, -drag);
    change = max(change, std::abs(normal - last[0]) / row.normal_mass);
    change = max(change, max(std::abs(ds), std::abs(dt)) * row.tangent_softness / softness);
  }
  if (block.moves_a) states[block.a].dx = a.dx, states[block.a].dtheta = a.dtheta;
  if (block.moves_b) states[block.b].dx = b.dx, states[block.b].dtheta = b.dtheta;
  return change;
}

void keep_block(const ContactBlock& block, RigidContact& contact) {
  for (std::uint32_t k = 0; k < block.count; ++k) {
    const ContactRow& row = block.rows[k];
    RigidContactPoint& point = contact.points[k];
    const bool pushes = row.impulse[0] > 0;
    point.normal_impulse = row.impulse[0];
    point.tangent_impulse = pushes ? block.in_world({0, row.impulse[1], row.impulse[2]}) : Vec3d{};
    point.slid = !pushes || !block.sticks(row);
  }
}

}  // namespace souple
