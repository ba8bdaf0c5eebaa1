#include "souple/rigid/contact_solver.h"

#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

// Part of an older overlap, or of the slip of a contact that sticks, that a substep removes.
constexpr double recovery = 0.01;
// Sweeps end when none changes a relative position by more than this part of g h^2, nor of what the first one changed.
constexpr double tolerance = 1e-3, relative_tolerance = 1e-6;
constexpr int first_sweeps = 2;
// Sweeps over so many contacts in all, within these bounds.
constexpr std::size_t most_visits = 8000, least_sweeps = 4, most_sweeps = 40;
// Multiplications of a step of Newton's method. Up to the first it is taken for any island, up to the second for those that
// are nearly at rest: they hardly move in h against each other.
constexpr double cheap = 3e5, affordable = 4e6;
constexpr double nearly_at_rest = 2;  // of g h^2
constexpr int most_cheap_steps = 6, most_steps = 2;

ContactBody state_of(const RigidBodies& bodies, std::size_t i) {
  ContactBody state;
  state.inverse_mass = bodies.mass[i].inverse;
  if (!(state.inverse_mass > 0)) return state;
  const Mat3d& I = bodies.inverse_inertia[i];
  state.inertia_diagonal = {I(0, 0), I(1, 1), I(2, 2)};
  state.inertia_rest = {I(1, 2), I(0, 2), I(0, 1)};
  return state;
}

}  // namespace

void ContactSolver::prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  impacts_.prepare(contacts, bodies);
  blocks_.reserve(contacts.size());
}

void ContactSolver::bounce(std::span<const RigidContact> contacts, RigidBodies& bodies,
                           const RigidSubstep& substep) {
  impacts_.bounce(contacts, bodies, substep);
  begun_ = false;
}

void ContactSolver::begin(std::span<RigidContact> contacts, const RigidBodies& bodies,
                          const RigidSubstep& substep, Threads& threads) {
  states_.assign(bodies.size() + 1, {});
  for (std::size_t i = 0; i < bodies.size(); ++i) states_[i] = state_of(bodies, i);
  blocks_.clear();
  for (std::uint32_t c = 0; c < contacts.size(); ++c)
    if (contacts[c].count > 0) blocks_.emplace_back().contact = c;
  const Depenetration depenetration{recovery, substep.depenetration_speed * substep.h};
  threads.for_each(blocks_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      start_block(contacts[blocks_[i].contact], blocks_[i], bodies, states_, depenetration);
  });
  islands_.find(blocks_, states_.size());
  changes_.resize(blocks_.size());
  local_.resize(states_.size());
  if (newton_.size() < islands_.islands().size()) newton_.resize(islands_.islands().size());
}

void ContactSolver::apply_last_impulses() {
  for (const ContactBlock& block : blocks_)
    for (std::uint32_t k = 0; k < block.count; ++k)
      block.push(states_, block.rows[k], block.in_world(block.rows[k].impulse));
}

double ContactSolver::sweep_colors(const ContactIslands::Island& island, bool forward, Threads& threads) {
  constexpr std::size_t grain = 16, exclusive = 63;  // the last of so many colors is for one thread
  const std::span<const ContactIslands::Range> colors = islands_.colors(island);
  for (std::size_t c = 0; c < colors.size(); ++c) {
    const std::size_t color = forward ? c : colors.size() - 1 - c;
    const std::span<const std::uint32_t> contacts = islands_.contacts(colors[color]);
    threads.for_each(contacts.size(), color == exclusive ? contacts.size() : grain,
                     [&](std::size_t begin, std::size_t end) {
                       for (std::size_t i = begin; i < end; ++i)
                         changes_[contacts[i]] = sweep_block(blocks_[contacts[i]], states_);
                     });
  }
  double change = 0;
  for (const std::uint32_t c : islands_.contacts(island.contacts)) change = max(change, changes_[c]);
  return change;
}

double ContactSolver::sweep(const ContactIslands::Island& island, bool forward, Threads& threads) {
  if (island.colors.size() > 0) return sweep_colors(island, forward, threads);
  const std::span<const std::uint32_t> contacts = islands_.contacts(island.contacts);
  double change = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i)
    change = max(change, sweep_block(blocks_[contacts[forward ? i : contacts.size() - 1 - i]], states_));
  return change;
}

void ContactSolver::solve_island(std::size_t i, const RigidSubstep& substep, Threads& threads) {
  const ContactIslands::Island& island = islands_.islands()[i];
  const std::span<const std::uint32_t> contacts = islands_.contacts(island.contacts);
  const double fall = substep.bounce_speed * substep.h / 2;  // g h^2
  const std::size_t most = std::clamp(most_visits / contacts.size(), least_sweeps, most_sweeps) *
                           static_cast<std::size_t>(substep.iterations);
  std::size_t count = 0;
  double change = 0, limit = fall * tolerance;
  const auto sweeps = [&](std::size_t end) {
    while (count < end) {
      change = sweep(island, count % 2 == 0, threads);
      if (count++ == 0) limit = max(limit, change * relative_tolerance);
      if (change <= limit) return true;
    }
    return false;
  };
  if (sweeps(first_sweeps)) return;
  ContactNewton& newton = newton_[i];
  newton.prepare(blocks_, contacts, local_);
  const int steps = newton.cost() <= cheap                                           ? most_cheap_steps
                    : newton.cost() <= affordable && change <= fall * nearly_at_rest ? most_steps
                                                                                     : 0;
  for (int step = 0; step < steps && newton.step(blocks_, contacts, local_, states_); ++step)
    if (sweeps(count + 1)) return;
  sweeps(max(count, most));
}

void ContactSolver::solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
                          Threads& threads) {
  const bool first = !begun_;
  if (first) begin(contacts, bodies, substep, threads);
  begun_ = true;
  before_ = states_;
  threads.for_each(blocks_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      measure_block(contacts[blocks_[i].contact], blocks_[i], bodies, states_);
  });
  if (first) apply_last_impulses();
  const std::span<const ContactIslands::Island> islands = islands_.islands();
  for (std::size_t i = 0; i < islands.size(); ++i)
    if (islands[i].colors.size() > 0) solve_island(i, substep, threads);
  threads.for_each(islands.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (islands[i].colors.size() == 0) solve_island(i, substep, threads);
  });
  for (const ContactBlock& block : blocks_) keep_block(block, contacts[block.contact]);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!(bodies.mass[i].inverse > 0)) continue;
    bodies.pose[i].position += states_[i].dx - before_[i].dx;
    bodies.pose[i].rotation = turned(bodies.pose[i].rotation, states_[i].dtheta - before_[i].dtheta);
  }
}

double ContactSolver::deepest(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  double result = 0;
  for (const RigidContact& contact : contacts)
    for (std::uint32_t k = 0; k < contact.count; ++k)
      result = max(result, -place(contact, contact.points[k], bodies.pose).C);
  return result;
}

std::size_t ContactSolver::bytes() const {
  std::size_t result =
      impacts_.bytes() + islands_.bytes() + bytes_of(states_, before_, blocks_, changes_, newton_, local_);
  for (const ContactNewton& newton : newton_) result += newton.bytes();
  return result;
}

}  // namespace souple
