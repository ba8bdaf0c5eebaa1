#include "souple/rigid/contact_solver.h"

#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

// Part of an older overlap, or of the slip of a contact that sticks, that a substep removes.
constexpr double recovery = 0.01;
// Sweeps end after one that changes relative positions by less than this part of g h^2, or of the first sweep's change.
constexpr double absolute_tolerance = 1e-3, relative_tolerance = 1e-6;
constexpr int first_sweeps = 2;
// Limit of sweeps times contacts; within it, the least and the largest number of sweeps.
constexpr std::size_t most_visits = 8000, least_sweeps = 4, most_sweeps = 40;
// Newton's method solves islands that are nearly at rest, whose bodies hardly move against each other in a substep. It
// is used if a factorization takes at most `affordable` multiplications and a step at most `in_a_step`.
constexpr double nearly_at_rest = 2;  // of g h^2
// Errors that may remain, as parts of g h^2 and of the tolerance. Errors of all substeps add up to a creep, of 16 um/s
// at the tolerance.
constexpr double exact = 1e-5, at_once = 0.1;
constexpr double affordable = 4e7, in_a_step = 4e8;
// Small islands are solved by Newton's method even while they move.
constexpr double cheap = 3e5, cheap_in_a_substep = 2e6;
constexpr int most_steps = 6, most_solves = 8;

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
  for (ContactNewton& newton : newton_) newton.forget();
  std::fill(budgets_.begin(), budgets_.end(), in_a_step);
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
  threads.each(blocks_.size(), 16, [&](std::size_t i) {
    start_block(contacts[blocks_[i].contact], blocks_[i], bodies, states_, depenetration);
  });
  islands_.find(blocks_, states_.size());
  changes_.resize(blocks_.size());
  local_.resize(states_.size());
  const std::size_t count = islands_.islands().size();
  if (newton_.size() < count) newton_.resize(count);
  budgets_.resize(states_.size(), in_a_step);
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

// The largest residual of a row that pushes or should [m].
double ContactSolver::residual(std::span<const std::uint32_t> contacts) const {
  double result = 0;
  for (const std::uint32_t c : contacts) {
    const ContactBlock& block = blocks_[c];
    for (std::uint32_t k = 0; k < block.count; ++k) {
      const ContactRow& row = block.rows[k];
      const ContactVector r = block.residual(states_, row);
      const bool pushes = row.impulse[0] > 0;
      result = max(result, pushes ? std::abs(r[0]) : -r[0]);
      if (pushes && block.sticks(row)) result = max(result, max(std::abs(r[1]), std::abs(r[2])));
    }
  }
  return result;
}

// Runs before any sweep: a sweep would disturb impulses that are almost right. An island that does not converge is no
// stack, so sweeps solve it in the rest of the step.
bool ContactSolver::solve_at_once(std::size_t i, double limit) {
  const ContactSystem system{blocks_, islands_.contacts(islands_.islands()[i].contacts), local_, states_};
  ContactNewton& newton = newton_[i];
  newton.prepare(system);
  if (newton.cost() > affordable) return false;
  double& budget = budgets_[islands_.islands()[i].lowest];
  const bool moved = newton.step(system, {most_solves, limit}, budget);
  if (moved && newton.converged()) return true;
  budget = 0;
  return false;
}

void ContactSolver::solve_island(std::size_t i, const RigidSubstep& substep, Threads& threads) {
  const ContactIslands::Island& island = islands_.islands()[i];
  const std::span<const std::uint32_t> contacts = islands_.contacts(island.contacts);
  const double fall = substep.bounce_speed * substep.h / 2;  // g h^2
  double limit = fall * absolute_tolerance;
  const double first = residual(contacts);
  if (first <= fall * exact) return;
  if (first <= fall * nearly_at_rest && solve_at_once(i, limit * at_once)) return;
  const std::size_t most = std::clamp(most_visits / contacts.size(), least_sweeps, most_sweeps) *
                           static_cast<std::size_t>(substep.iterations);
  std::size_t count = 0;
  double change = 0;
  const auto sweeps = [&](std::size_t end) {
    while (count < end) {
      change = sweep(island, count % 2 == 0, threads);
      if (count++ == 0) limit = max(limit, change * relative_tolerance);
      if (change <= limit) return true;
    }
    return false;
  };
  if (sweeps(first_sweeps)) return;
  if (island.colors.size() == 0) {
    const ContactSystem system{blocks_, contacts, local_, states_};
    ContactNewton& newton = newton_[i];
    newton.prepare(system);
    double budget = cheap_in_a_substep;
    for (int step = 0; newton.cost() <= cheap && step < most_steps; ++step) {
      newton.step(system, {1, limit}, budget);  // if it fails, a sweep changes where it begins
      if (sweeps(count + 1)) return;
    }
  }
  sweeps(max(count, most));
}

void ContactSolver::choose(std::span<const std::uint8_t> chosen) {
  chosen_.assign(states_.size(), 1);
  if (chosen.empty()) return;
  std::copy(chosen.begin(), chosen.end(), chosen_.begin());
  for (const ContactIslands::Island& island : islands_.islands()) {
    const std::span<const std::uint32_t> contacts = islands_.contacts(island.contacts);
    const bool any = std::any_of(contacts.begin(), contacts.end(), [&](std::uint32_t c) {
      const ContactBlock& block = blocks_[c];
      return (block.moves_a && chosen[block.a] != 0) || (block.moves_b && chosen[block.b] != 0);
    });
    for (const std::uint32_t c : contacts) {
      if (blocks_[c].moves_a) chosen_[blocks_[c].a] = any ? 1 : 0;
      if (blocks_[c].moves_b) chosen_[blocks_[c].b] = any ? 1 : 0;
    }
  }
}

void ContactSolver::solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
                          Threads& threads, std::span<const std::uint8_t> chosen) {
  const bool first = !begun_;
  if (first) begin(contacts, bodies, substep, threads);
  begun_ = true;
  before_ = states_;
  choose(chosen);
  threads.each(blocks_.size(), 16, [&](std::size_t i) {
    if (is_chosen(blocks_[i])) measure_block(contacts[blocks_[i].contact], blocks_[i], bodies, states_);
  });
  if (first) apply_last_impulses();
  const std::span<const ContactIslands::Island> islands = islands_.islands();
  for (std::size_t i = 0; i < islands.size(); ++i)
    if (islands[i].colors.size() > 0 && chosen_[islands[i].lowest] != 0) solve_island(i, substep, threads);
  threads.each(islands.size(), 1, [&](std::size_t i) {
    if (islands[i].colors.size() == 0 && chosen_[islands[i].lowest] != 0) solve_island(i, substep, threads);
  });
  energy_.limit(islands_, bodies, substep, before_, states_, blocks_);
  for (const ContactBlock& block : blocks_) keep_block(block, contacts[block.contact]);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!(bodies.mass[i].inverse > 0) || chosen_[i] == 0) continue;
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
  std::size_t result = impacts_.bytes() + islands_.bytes() + energy_.bytes() +
                       bytes_of(states_, before_, blocks_, changes_, newton_, budgets_, chosen_, local_);
  for (const ContactNewton& newton : newton_) result += newton.bytes();
  return result;
}

}  // namespace souple
