#include "souple/rigid/contact_energy.h"

#include "souple/state/bytes.h"

namespace souple {
namespace {

// An island may gain this part of what it had, by rounding.
constexpr double most_gain = 1e-3;

/// Moments of inertia are those of the predicted pose.
Vec3d momentum_of(const BodyMass& mass, const Quatd& rotation, const Vec3d& angular) {
  const Vec3d local = rotate(conjugate(rotation), angular), &w = mass.inverse_inertia;
  const auto over = [](double x, double inverse) { return inverse > 0 ? x / inverse : 0.0; };
  return rotate(rotation, Vec3d{over(local.x, w.x), over(local.y, w.y), over(local.z, w.z)});
}

}  // namespace

void ContactEnergy::limit(ContactIslands& islands, const RigidBodies& bodies, const RigidSubstep& substep,
                          std::span<const ContactBody> before, std::span<ContactBody> states,
                          std::span<ContactBlock> blocks) {
  energies_.assign(islands.islands().size(), {});
  const double h = substep.h;
  const double free_move = substep.depenetration_speed * h + length(substep.gravity) * h * h;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::uint32_t island = islands.of(static_cast<std::uint32_t>(i));
    if (island == ContactIslands::none || !(bodies.mass[i].inverse > 0)) continue;
    Energy& energy = energies_[island];
    const double m = 1 / bodies.mass[i].inverse;
    const Vec3d moved = bodies.pose[i].position - bodies.start[i].position;
    const Vec3d turned = bodies.velocity[i].angular * h + before[i].dtheta;
    const Vec3d dx = states[i].dx - before[i].dx, dtheta = states[i].dtheta - before[i].dtheta;
    const Vec3d L = momentum_of(bodies.mass[i], bodies.pose[i].rotation, turned);
    energy.a += (m * length_squared(moved) + dot(turned, L)) / 2;
    energy.b += m * dot(moved, dx) + dot(dtheta, L);
    energy.c +=
        (m * length_squared(dx) + dot(dtheta, momentum_of(bodies.mass[i], bodies.pose[i].rotation, dtheta))) /
        2;
    energy.allowed += m * free_move * free_move;
  }
  for (std::uint32_t k = 0; k < islands.islands().size(); ++k) {
    Energy& energy = energies_[k];
    if (!(energy.b + energy.c > most_gain * energy.a + energy.allowed)) continue;
    for (const std::uint32_t c : islands.contacts(islands.islands()[k].contacts))
      for (const std::uint32_t side : {blocks[c].a, blocks[c].b})
        energy.is_driven =
            energy.is_driven ||
            (side < bodies.size() && !(bodies.mass[side].inverse > 0) &&
             (bodies.velocity[side].linear != Vec3d{} || bodies.velocity[side].angular != Vec3d{}));
    if (energy.is_driven) continue;
    energy.scale = min(1.0, max(0.0, -energy.b / (2 * energy.c)));
    for (const std::uint32_t c : islands.contacts(islands.islands()[k].contacts))
      for (ContactRow& row : blocks[c].rows)
        for (double& impulse : row.impulse) impulse *= energy.scale;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::uint32_t island = islands.of(static_cast<std::uint32_t>(i));
    if (island == ContactIslands::none || energies_[island].scale == 1) continue;
    states[i].dx = before[i].dx + (states[i].dx - before[i].dx) * energies_[island].scale;
    states[i].dtheta = before[i].dtheta + (states[i].dtheta - before[i].dtheta) * energies_[island].scale;
  }
}

std::size_t ContactEnergy::bytes() const {
  return bytes_of(energies_);
}

}  // namespace souple
