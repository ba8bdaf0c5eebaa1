#include "souple/rigid/contact_solver.h"

#include "souple/contacts/contact_law.h"
#include "souple/rigid/body_block.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <array>
#include <bit>

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
Vec3d center(std::span<const BodyPose> poses, std::uint32_t body) {
  return body == no_body ? Vec3d{} : poses[body].position;
}

/// A contact at given poses.
struct Placed {
  Vec3d n{};     // from b to a
  Vec3d x{};     // where the sides touch [m]
  double C = 0;  // [m]
};

Placed place(const RigidContact& contact, const RigidContactPoint& point, std::span<const BodyPose> poses) {
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
  // Sides that slide leave the point of a face behind: a corner of the other side says where they touch.
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

double reciprocal(double x) {
  return x > 0 ? 1 / x : 0;
}

Vec3d tangential(const Vec3d& v, const Vec3d& n) {
  return v - n * dot(n, v);
}

/// A point of a contact before the substep's motion.
struct Impact {
  Vec3d n{}, r_a{}, r_b{};
  double approach = 0;                       // [m/s]
  double normal_mass = 0, tangent_mass = 0;  // the latter is the least of all tangential directions [kg]
  bool closes = false;                       // within the substep
  bool bounces = false;                      // and fast enough
  double normal = 0;                         // impulse [N s]
  Vec3d tangent{};
};

/// Whether the point is nearer than its sides approach each other within the substep.
Impact impact_at(const RigidContact& contact, const RigidContactPoint& point, const RigidBodies& bodies,
                 const RigidSubstep& substep) {
  const Placed at = place(contact, point, bodies.pose);
  Impact impact{
      .n = at.n, .r_a = at.x - center(bodies.pose, contact.a), .r_b = at.x - center(bodies.pose, contact.b)};
  const Vec3d u = velocity_at(bodies, contact.a, impact.r_a) - velocity_at(bodies, contact.b, impact.r_b);
  impact.approach = -dot(at.n, u);
  impact.bounces = impact.approach > substep.bounce_speed && at.C <= impact.approach * substep.h;
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
/// change it by P . (u + u') / 2, where u and u' are the relative velocities before and after: of s times the impulses,
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

double lighter_mass(const RigidContact& contact, const RigidBodies& bodies) {
  double largest = 0;
  for (const std::uint32_t body : {contact.a, contact.b})
    if (moves(bodies, body)) largest = max(largest, bodies.mass[body].inverse);
  return reciprocal(largest);
}

// Stiffness of the augmented Lagrangian, in units of the lighter body's m / h^2: so stiff that one sweep leaves little,
// and well above the stiffness of inertia that a stack of bodies has to pass on.
constexpr double stiffness_ratio = 80;
// Part of an older overlap, or of the slip of a contact that sticks, that a substep removes.
constexpr double recovery = 0.01;
// Part of a substep's forces that the next one begins with: below 1, else an error would travel through a stack.
constexpr double decay = 0.99;

}  // namespace

void ContactSolver::prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  side_begin_.assign(bodies.size() + 1, 0);
  const auto for_each_side = [&](const auto& f) {
    for (std::uint32_t c = 0; c < contacts.size(); ++c)
      for (const bool is_a : {true, false}) {
        const std::uint32_t body = is_a ? contacts[c].a : contacts[c].b;
        if (moves(bodies, body)) f(body, Side{c, is_a});
      }
  };
  for_each_side([&](std::uint32_t body, Side) { ++side_begin_[body + 1]; });
  for (std::size_t i = 0; i < bodies.size(); ++i) side_begin_[i + 1] += side_begin_[i];
  sides_.resize(side_begin_.back());
  color_.assign(side_begin_.begin(), side_begin_.end());  // where the next side goes
  for_each_side([&](std::uint32_t body, Side side) { sides_[color_[body]++] = side; });
  color_bodies(contacts, bodies);
}

// Bodies of one color share no contact. In the order of bodies, each takes the first color that no earlier neighbor has.
void ContactSolver::color_bodies(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  constexpr std::uint32_t none = ~std::uint32_t{0};
  constexpr std::uint32_t most = 63;  // the last color may hold neighbors: it is solved by one thread
  color_.assign(bodies.size(), none);
  color_begin_.assign(most + 2, 0);
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    if (side_begin_[i] == side_begin_[i + 1]) continue;
    std::uint64_t taken = 0;
    for (std::uint32_t k = side_begin_[i]; k < side_begin_[i + 1]; ++k) {
      const RigidContact& contact = contacts[sides_[k].contact];
      const std::uint32_t other = sides_[k].is_a ? contact.b : contact.a;
      if (other != no_body && color_[other] != none) taken |= std::uint64_t{1} << color_[other];
    }
    color_[i] = std::min(static_cast<std::uint32_t>(std::countr_one(taken)), most);
    ++color_begin_[color_[i] + 1];
  }
  for (std::uint32_t c = 0; c <= most; ++c) color_begin_[c + 1] += color_begin_[c];
  order_.resize(color_begin_.back());
  std::array<std::uint32_t, most + 1> next;
  std::copy_n(color_begin_.begin(), next.size(), next.begin());
  for (std::uint32_t i = 0; i < bodies.size(); ++i)
    if (color_[i] != none) order_[next[color_[i]]++] = i;
}

void ContactSolver::linearize(RigidContact& contact, std::span<Row> rows, const RigidBodies& bodies,
                              const RigidSubstep& substep) const {
  const double inverse_h2 = 1 / (substep.h * substep.h);
  const double stiffness = stiffness_ratio * lighter_mass(contact, bodies) * inverse_h2;
  for (std::uint32_t k = 0; k < contact.count; ++k) {
    RigidContactPoint& point = contact.points[k];
    const Placed before = place(contact, point, bodies.start), now = place(contact, point, bodies.pose);
    Row& row = rows[k];
    if (!point.anchored || point.slid || contact.radius_a + contact.radius_b > 0) {
      point.anchor_a = local_point(bodies.start, contact.a, before.x);
      point.anchor_b = local_point(bodies.start, contact.b, before.x);
      point.anchored = true, point.slid = false;
    }
    const auto slip = [&](std::span<const BodyPose> poses) {
      return world_point(poses, contact.a, point.anchor_a) - world_point(poses, contact.b, point.anchor_b);
    };
    row.n = now.n;
    row.r_a = now.x - center(bodies.pose, contact.a), row.r_b = now.x - center(bodies.pose, contact.b);
    const double overlap = max(-before.C, 0.0);
    const double removed = min(overlap * recovery, substep.depenetration_speed * substep.h);
    row.C = now.C + (overlap - removed);
    row.slip = tangential(slip(bodies.pose) - slip(bodies.start) * (1 - recovery), row.n);
    row.stiffness = stiffness;
    row.normal = point.normal_impulse * (decay * inverse_h2);
    row.tangent = tangential(point.tangent_impulse, row.n) * (decay * inverse_h2);
    row.static_friction = contact.material.static_friction;
    row.kinetic_friction = contact.material.kinetic_friction;
  }
}

/// dx_a + dtheta_a x r_a - dx_b - dtheta_b x r_b.
Vec3d ContactSolver::correction_at(const RigidContact& contact, const Row& row) const {
  const auto at = [this](std::uint32_t body, const Vec3d& r) {
    if (body == no_body) return Vec3d{};
    return corrections_[body].dx + cross(corrections_[body].dtheta, r);
  };
  return at(contact.a, row.r_a) - at(contact.b, row.r_b);
}

ContactSolver::Push ContactSolver::push_of(const RigidContact& contact, const Row& row) const {
  const Vec3d correction = correction_at(contact, row);
  Push push;
  push.normal = max(row.normal - row.stiffness * (row.C + dot(row.n, correction)), 0.0);
  push.sticking = row.tangent - (row.slip + tangential(correction, row.n)) * row.stiffness;
  push.tangent = within_friction(push.sticking, static_cast<double>(row.static_friction),
                                 static_cast<double>(row.kinetic_friction), push.normal);
  push.slides = length_squared(push.tangent) < length_squared(push.sticking);
  return push;
}

bool ContactSolver::step_body(std::uint32_t body, std::span<const RigidContact> contacts,
                              const RigidBodies& bodies, double h) {
  Correction& correction = corrections_[body];
  BodyBlock block(1 / bodies.mass[body].inverse, inertia_[body], 1 / (h * h), correction.dx,
                  correction.dtheta);
  bool any = false;
  const auto for_each_row = [&](const auto& f) {
    for (std::uint32_t s = side_begin_[body]; s < side_begin_[body + 1]; ++s)
      for (std::uint32_t k = 0; k < contacts[sides_[s].contact].count; ++k)
        f(sides_[s], contacts[sides_[s].contact], rows_[sides_[s].contact * 4 + k]);
  };
  for_each_row([&](const Side& side, const RigidContact& contact, Row& row) {
    const Push push = push_of(contact, row);
    row.pushes = push.normal > 0;
    // A contact that has just ceased to push still counts as stiff: of many sweeps, one would undo the other.
    if (!row.pushes && !(row.normal > 0)) return;
    any = true;
    const double sign = side.is_a ? 1 : -1;
    block.add(side.is_a ? row.r_a : row.r_b, (row.n * push.normal + push.tangent) * sign, row.stiffness);
  });
  if (!any && length_squared(correction.dx) + length_squared(correction.dtheta) == 0) return false;
  const BodyBlock::Step step = block.step();
  correction.dx += step.dx, correction.dtheta += step.dtheta;
  bool pulls = false;
  for_each_row([&](const Side& /*side*/, const RigidContact& contact, const Row& row) {
    pulls = pulls || (row.pushes && !(push_of(contact, row).normal > 0));
  });
  return pulls;
}

// A step is linear: a contact that pushed before it may have pulled in it. The next step is without it.
void ContactSolver::solve_body(std::uint32_t body, std::span<const RigidContact> contacts,
                               const RigidBodies& bodies, double h) {
  constexpr int most_steps = 4;
  for (int i = 0; i < most_steps; ++i)
    if (!step_body(body, contacts, bodies, h)) return;
}

void ContactSolver::keep(RigidContact& contact, std::span<Row> rows, double h) const {
  for (std::uint32_t k = 0; k < contact.count; ++k) {
    Row& row = rows[k];
    const Push push = push_of(contact, row);
    row.normal = push.normal, row.tangent = push.normal > 0 ? push.tangent : Vec3d{};
    RigidContactPoint& point = contact.points[k];
    point.normal_impulse = push.normal * h * h;
    point.tangent_impulse = row.tangent * (h * h);
    point.slid = !(push.normal > 0) || push.slides;
  }
}

void ContactSolver::solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
                          Threads& threads) {
  rows_.resize(contacts.size() * 4);
  corrections_.assign(bodies.size(), {});
  inertia_.resize(bodies.size());
  const auto rows_of = [this](std::size_t c) { return std::span(rows_).subspan(c * 4, 4); };
  threads.for_each(order_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      inertia_[order_[k]] = inverse(bodies.inverse_inertia[order_[k]]);
  });
  threads.for_each(contacts.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) linearize(contacts[c], rows_of(c), bodies, substep);
  });
  for (int i = 0; i < substep.iterations; ++i) {
    for (std::size_t c = 0; c + 1 < color_begin_.size(); ++c) {
      const std::size_t first = color_begin_[c], count = color_begin_[c + 1] - first;
      const std::size_t grain = c + 2 == color_begin_.size() ? count : 8;
      threads.for_each(count, std::max<std::size_t>(grain, 1), [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) solve_body(order_[first + k], contacts, bodies, substep.h);
      });
    }
    threads.for_each(contacts.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) keep(contacts[c], rows_of(c), substep.h);
    });
  }
  for (const std::uint32_t i : order_) {
    bodies.pose[i].position += corrections_[i].dx;
    bodies.pose[i].rotation = turned(bodies.pose[i].rotation, corrections_[i].dtheta);
  }
}

double ContactSolver::deepest(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  double result = 0;
  for (const RigidContact& contact : contacts)
    for (std::uint32_t k = 0; k < contact.count; ++k)
      result = max(result, -place(contact, contact.points[k], bodies.pose).C);
  return result;
}

bool ContactSolver::collide(const RigidContact& contact, RigidBodies& bodies, const RigidSubstep& substep) {
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
      const double target = impact.bounces ? e * impact.approach : 0.0;
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

void ContactSolver::bounce(std::span<const RigidContact> contacts, RigidBodies& bodies,
                           const RigidSubstep& substep) {
  constexpr int most_sweeps = 32;
  impacts_.clear();
  impacts_.reserve(contacts.size()), next_impacts_.reserve(contacts.size());
  waits_.assign(contacts.size(), 1);  // those without points, forever
  for (std::uint32_t c = 0; c < contacts.size(); ++c)
    if (contacts[c].count > 0) impacts_.push_back(c);
  for (int sweep = 0; !impacts_.empty() && sweep < most_sweeps; ++sweep) {
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

void ContactSolver::look_again(std::uint32_t body) {
  for (std::uint32_t s = side_begin_[body]; s < side_begin_[body + 1]; ++s) {
    const std::uint32_t contact = sides_[s].contact;
    if (waits_[contact] == 0) next_impacts_.push_back(contact), waits_[contact] = 1;
  }
}

std::size_t ContactSolver::bytes() const {
  return bytes_of(rows_, corrections_, inertia_, side_begin_, sides_, color_, order_, color_begin_, impacts_,
                  next_impacts_, waits_);
}

}  // namespace souple
