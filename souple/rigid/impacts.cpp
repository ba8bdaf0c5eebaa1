#include "souple/rigid/impacts.h"

#include "souple/contacts/contact_law.h"
#include "souple/rigid/contact_block.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace souple {
namespace {

double reciprocal(double x) {
  return x > 0 ? 1 / x : 0;
}

/// A point of a contact before the substep's motion.
struct Impact {
  Vec3d n{}, r_a{}, r_b{};
  double C = 0;                              // [m]
  double approach = 0;                       // [m/s]
  double normal_mass = 0, tangent_mass = 0;  // the latter is the least of all tangential directions [kg]
  bool closes = false;                       // within the substep
  bool bounces = false;                      // and fast enough
  double normal = 0;                         // impulse [N s]
  Vec3d tangent{};
};

// An impact at an eccentric point turns a body. Contacts remove the approach by linearized positional impulses, which
// are inexact for large turns. So an approach beyond this part of the arm in a substep is stopped in velocities, even
// without restitution.
constexpr double fast_part = 0.25;

/// From the point to the nearer center of a side that moves [m].
double shorter_arm(const Impact& impact, const RigidContact& contact, const RigidBodies& bodies) {
  double square = std::numeric_limits<double>::infinity();
  if (moves(bodies, contact.a)) square = length_squared(impact.r_a);
  if (moves(bodies, contact.b)) square = min(square, length_squared(impact.r_b));
  return std::sqrt(square);
}

/// Whether the point is nearer than its sides approach each other within the substep.
Impact impact_at(const RigidContact& contact, const RigidContactPoint& point, const RigidBodies& bodies,
                 const RigidSubstep& substep) {
  const PlacedContact at = place(contact, point, bodies.pose);
  Impact impact{.n = at.n,
                .r_a = at.x - center_of(bodies.pose, contact.a),
                .r_b = at.x - center_of(bodies.pose, contact.b),
                .C = at.C};
  const Vec3d u = velocity_at(bodies, contact.a, impact.r_a) - velocity_at(bodies, contact.b, impact.r_b);
  impact.approach = -dot(at.n, u);
  impact.bounces = impact.approach > substep.bounce_speed && at.C <= impact.approach * substep.h &&
                   (contact.material.restitution > 0 ||
                    impact.approach * substep.h > fast_part * shorter_arm(impact, contact, bodies));
  impact.closes = at.C <= max(impact.approach, substep.bounce_speed) * substep.h;
  return impact;
}

void find_masses(Impact& impact, const RigidContact& contact, const RigidBodies& bodies) {
  const Mat3d K =
      inverse_mass_at(bodies, contact.a, impact.r_a) + inverse_mass_at(bodies, contact.b, impact.r_b);
  const double normal = dot(impact.n, K * impact.n);
  impact.normal_mass = reciprocal(normal), impact.tangent_mass = reciprocal(trace(K) - normal);
}

std::array<BodyVelocity, 2> velocities_of(const RigidContact& contact, const RigidBodies& bodies) {
  std::array<BodyVelocity, 2> result{};
  if (contact.a != no_body) result[0] = bodies.velocity[contact.a];
  if (contact.b != no_body) result[1] = bodies.velocity[contact.b];
  return result;
}

/// With friction, Newton's restitution may add energy (Stronge 1990, "Rigid body collisions with friction"). Impulses P
/// change it by P . (u + u') / 2, where u and u' are the relative velocities before and after. Impulses s P change it
/// by s P . u + s^2 P . (u' - u) / 2. So s is the largest one, up to 1, that adds none.
void give_back_energy(std::span<const Impact> impacts, const RigidContact& contact,
                      const std::array<BodyVelocity, 2>& before, RigidBodies& bodies) {
  const std::array<BodyVelocity, 2> after = velocities_of(contact, bodies);
  double linear = 0, square = 0;  // P . u, P . (u' - u)
  for (std::size_t k = 0; k < contact.count; ++k) {
    const Impact& impact = impacts[k];
    const Vec3d P = impact.n * impact.normal + impact.tangent;
    const Vec3d u = before[0].at(impact.r_a) - before[1].at(impact.r_b);
    linear += dot(P, u), square += dot(P, after[0].at(impact.r_a) - after[1].at(impact.r_b) - u);
  }
  if (!(linear < 0 && linear + square / 2 > 0)) return;
  const double s = -2 * linear / square;
  const auto scale = [&](std::uint32_t body, const BodyVelocity& v) {
    if (body == no_body) return;
    BodyVelocity& now = bodies.velocity[body];
    now = {v.linear + (now.linear - v.linear) * s, v.angular + (now.angular - v.angular) * s};
  };
  scale(contact.a, before[0]), scale(contact.b, before[1]);
}

/// Normal speed after an impact. The sides turn round early, at the distance C. From there they rise as if they had met
/// at C = 0. So v'^2 + 2 g C = e^2 (v^2 + 2 g C), with g the acceleration at which they approach.
double restitution_speed(double e, const Impact& impact, const RigidContact& contact,
                         const RigidBodies& bodies, const RigidSubstep& substep) {
  const double sides = (moves(bodies, contact.a) ? 1 : 0) - (moves(bodies, contact.b) ? 1 : 0);
  const double gain = -2 * sides * dot(impact.n, substep.gravity) * max(impact.C, 0.0);
  const double v = impact.approach;
  return std::sqrt(max(e * e * (v * v + gain) - gain, 0.0));
}

}  // namespace

void Impacts::prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  contacts_of_.fill(bodies.size(), [&](const auto& add) {
    for (std::uint32_t c = 0; c < contacts.size(); ++c)
      for (const std::uint32_t body : {contacts[c].a, contacts[c].b})
        if (moves(bodies, body)) add(body, c);
  });
}

bool Impacts::collide(const RigidContact& contact, RigidBodies& bodies, const RigidSubstep& substep) {
  std::array<Impact, 4> impacts;
  bool closing = false;
  for (std::uint32_t k = 0; k < contact.count; ++k) {
    impacts[k] = impact_at(contact, contact.points[k], bodies, substep);
    closing = closing || impacts[k].bounces;
  }
  if (!closing) return false;
  for (std::uint32_t k = 0; k < contact.count; ++k) find_masses(impacts[k], contact, bodies);
  const std::array<BodyVelocity, 2> before = velocities_of(contact, bodies);
  const auto e = static_cast<double>(contact.material.restitution);
  constexpr int rounds = 20;  // of at most four points
  for (int round = 0; round < rounds; ++round)
    for (std::uint32_t k = 0; k < contact.count; ++k) {
      Impact& impact = impacts[k];
      if (!impact.closes) continue;
      const Vec3d u = velocity_at(bodies, contact.a, impact.r_a) - velocity_at(bodies, contact.b, impact.r_b);
      const double target = impact.bounces ? restitution_speed(e, impact, contact, bodies, substep) : 0.0;
      const double normal = max(impact.normal + (target - dot(impact.n, u)) * impact.normal_mass, 0.0);
      const Vec3d slip = tangential(u, impact.n);
      const Vec3d tangent = within_friction(tangential(impact.tangent, impact.n) - slip * impact.tangent_mass,
                                            static_cast<double>(contact.material.static_friction),
                                            static_cast<double>(contact.material.kinetic_friction), normal);
      const Vec3d impulse = impact.n * (normal - impact.normal) + (tangent - impact.tangent);
      push_velocity(bodies, contact.a, impact.r_a, impulse);
      push_velocity(bodies, contact.b, impact.r_b, -impulse);
      impact.normal = normal, impact.tangent = tangent;
    }
  give_back_energy(impacts, contact, before, bodies);
  return true;
}

void Impacts::bounce(std::span<const RigidContact> contacts, RigidBodies& bodies,
                     const RigidSubstep& substep) {
  constexpr int most_rounds = 32;
  impacts_.clear();
  impacts_.reserve(contacts.size()), next_impacts_.reserve(contacts.size());
  waits_.assign(contacts.size(), 1);  // those without points, forever
  for (std::uint32_t c = 0; c < contacts.size(); ++c)
    if (contacts[c].count > 0) impacts_.push_back(c);
  for (int sweep = 0; !impacts_.empty() && sweep < most_rounds; ++sweep) {
    next_impacts_.clear();
    for (const std::uint32_t c : impacts_) waits_[c] = 0;
    for (const std::uint32_t c : impacts_) {
      if (!collide(contacts[c], bodies, substep)) continue;
      for (const std::uint32_t body : {contacts[c].a, contacts[c].b})
        if (moves(bodies, body)) look_again(body);
    }
    std::sort(next_impacts_.begin(), next_impacts_.end());
    std::swap(impacts_, next_impacts_);
  }
}

void Impacts::look_again(std::uint32_t body) {
  for (const std::uint32_t contact : contacts_of_[body])
    if (waits_[contact] == 0) next_impacts_.push_back(contact), waits_[contact] = 1;
}

std::size_t Impacts::bytes() const {
  return bytes_of(impacts_, next_impacts_, waits_) + contacts_of_.bytes();
}

}  // namespace souple
