#include "souple/rigid/contact_solver.h"

#include "souple/contacts/contact_law.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace souple {
namespace {

Vec3d world_point(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& local) {
  return body == no_body ? local : poses[body].point(local);
}
Vec3d local_point(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& world) {
  return body == no_body ? world : poses[body].local_point(world);
}
Vec3d center(std::span<const BodyPose> poses, std::uint32_t body) {
  return body == no_body ? Vec3d{} : poses[body].position;
}
double reciprocal(double x) {
  return x > 0 ? 1 / x : 0;
}

Vec3d any_tangent(const Vec3d& n) {
  const Vec3d axis = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalized(tangential(axis, n));
}

double response(const ContactBlock& block, const ContactRow& row, const ContactBody& a, const ContactBody& b,
                const Vec3d& s, const Vec3d& t) {
  const Vec3d a_s = cross(row.r_a, s), a_t = cross(row.r_a, t), b_s = cross(row.r_b, s), b_t = cross(row.r_b, t);
  (void)block;
  return (a.inverse_mass + b.inverse_mass) * dot(s, t) + dot(a_s, a.spin_of(a_t)) + dot(b_s, b.spin_of(b_t));
}

/// One pass over the points of a contact. The largest change of a relative position [m].
double sweep_block(ContactBlock& block, std::span<ContactBody> bodies, int rounds) {
  ContactBody a = bodies[block.a], b = bodies[block.b];
  double change = 0;
  for (int round = 0; round < rounds; ++round) {
  double here = 0;
  for (std::uint32_t k = 0; k < block.count; ++k) {
    ContactRow& row = block.rows[k];
    Vec3d u = a.correction_at(row.r_a) - b.correction_at(row.r_b);
    const double residual = row.C + dot(block.n, u) + (row.normal - row.last[0]) * row.normal_softness;
    const double normal = max(row.normal - residual * row.normal_mass, 0.0);
    if (normal == 0 && row.normal == 0) continue;
    const double dn = normal - row.normal;
    row.normal = normal;
    {
      const Vec3d P = block.n * dn;
      a.push(row.r_a, P), b.push(row.r_b, -P);
      u = a.correction_at(row.r_a) - b.correction_at(row.r_b);
    }
    const double s0 = row.slip[0] + dot(block.t0, u) + (row.tangent[0] - row.last[1]) * row.tangent_softness;
    const double s1 = row.slip[1] + dot(block.t1, u) + (row.tangent[1] - row.last[2]) * row.tangent_softness;
    double p0 = row.tangent[0] - (row.tangent_00 * s0 + row.tangent_01 * s1);
    double p1 = row.tangent[1] - (row.tangent_01 * s0 + row.tangent_11 * s1);
    const double size2 = p0 * p0 + p1 * p1, limit = block.static_friction * normal;
    if (size2 > limit * limit) {
      const double scale = block.kinetic_friction * normal / std::sqrt(size2);
      p0 *= scale, p1 *= scale;
    }
    const double d0 = p0 - row.tangent[0], d1 = p1 - row.tangent[1];
    row.tangent = {p0, p1};
    const Vec3d P = block.t0 * d0 + block.t1 * d1;
    a.push(row.r_a, P), b.push(row.r_b, -P);
    here = max(here, max(std::abs(dn) / row.normal_mass, max(std::abs(d0), std::abs(d1)) * row.tangent_inverse));
  }
  if (round == 0) change = here;
  if (here == 0) break;
  }
  if (block.moves_a) bodies[block.a].dx = a.dx, bodies[block.a].dtheta = a.dtheta;
  if (block.moves_b) bodies[block.b].dx = b.dx, bodies[block.b].dtheta = b.dtheta;
  return change;
}

}  // namespace

void ContactSolver::prepare(std::span<const RigidContact> contacts, const RigidBodies& bodies) {
  impacts_.prepare(contacts, bodies);
}

void ContactSolver::bounce(std::span<const RigidContact> contacts, RigidBodies& bodies,
                           const RigidSubstep& substep) {
  impacts_.bounce(contacts, bodies, substep);
  begun_ = false;
}

void ContactSolver::read_bodies(const RigidBodies& bodies) {
  states_.assign(bodies.size() + 1, {});
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    ContactBody& s = states_[i];
    const Mat3d& I = bodies.inverse_inertia[i];
    s.inverse_mass = bodies.mass[i].inverse;
    s.inertia_diagonal = {I(0, 0), I(1, 1), I(2, 2)};
    s.inertia_rest = {I(1, 2), I(0, 2), I(0, 1)};
    if (!(s.inverse_mass > 0)) s.inertia_diagonal = {}, s.inertia_rest = {};
  }
}

void ContactSolver::linearize(RigidContact& contact, ContactBlock& block, const RigidBodies& bodies,
                              const RigidSubstep& substep) const {
  const auto index = [&](std::uint32_t body) {
    return body == no_body ? static_cast<std::uint32_t>(bodies.size()) : body;
  };
  block.a = index(contact.a), block.b = index(contact.b);
  block.moves_a = moves(bodies, contact.a), block.moves_b = moves(bodies, contact.b);
  block.static_friction = static_cast<double>(contact.material.static_friction);
  block.kinetic_friction = static_cast<double>(contact.material.kinetic_friction);
  block.count = contact.count;
  const ContactBody &a = states_[block.a], &b = states_[block.b];
  for (std::uint32_t k = 0; k < contact.count; ++k) {
    RigidContactPoint& point = contact.points[k];
    const PlacedContact before = place(contact, point, bodies.start), now = place(contact, point, bodies.pose);
    ContactRow& row = block.rows[k];
    if (!point.anchored || point.slid || contact.radius_a + contact.radius_b > 0) {
      point.anchor_a = local_point(bodies.start, contact.a, before.x);
      point.anchor_b = local_point(bodies.start, contact.b, before.x);
      point.anchored = true, point.slid = false;
    }
    if (k == 0) {
      block.n = before.n, block.t0 = any_tangent(before.n), block.t1 = cross(block.n, block.t0);
    }
    const auto slip = [&](std::span<const BodyPose> poses) {
      return world_point(poses, contact.a, point.anchor_a) - world_point(poses, contact.b, point.anchor_b);
    };
    row.r_a = before.x - center(bodies.start, contact.a), row.r_b = before.x - center(bodies.start, contact.b);
    const double knn = response(block, row, a, b, block.n, block.n);
    double k00 = response(block, row, a, b, block.t0, block.t0);
    const double k01 = response(block, row, a, b, block.t0, block.t1);
    double k11 = response(block, row, a, b, block.t1, block.t1);
    row.normal_softness = knn / kappa, row.tangent_softness = (k00 + k11) / kappa_t;
    row.normal_mass = reciprocal(knn + row.normal_softness);
    k00 += row.tangent_softness, k11 += row.tangent_softness;
    const double d = reciprocal(k00 * k11 - k01 * k01);
    row.tangent_00 = k11 * d, row.tangent_01 = -k01 * d, row.tangent_11 = k00 * d;
    row.tangent_inverse = k00 + k11;
    row.normal = point.normal_impulse;
    row.tangent = {dot(point.tangent_impulse, block.t0), dot(point.tangent_impulse, block.t1)};
    const double overlap = max(-(before.C + row.normal_softness * row.normal), 0.0);
    const double removed = min(overlap * recovery, substep.depenetration_speed * substep.h);
    row.C = now.C + (overlap - removed);
    const Vec3d unstrained = slip(bodies.start) + (block.t0 * row.tangent[0] + block.t1 * row.tangent[1]) * row.tangent_softness;
    const Vec3d slipped = slip(bodies.pose) - unstrained * (1 - recovery);
    row.slip = {dot(block.t0, slipped), dot(block.t1, slipped)};
  }
}

void ContactSolver::find_islands() {
  root_.resize(states_.size());
  for (std::uint32_t i = 0; i < root_.size(); ++i) root_[i] = i;
  const auto find = [this](std::uint32_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  };
  for (const ContactBlock& block : blocks_) {
    if (!block.moves_a || !block.moves_b) continue;
    const std::uint32_t a = find(block.a), b = find(block.b);
    root_[std::max(a, b)] = std::min(a, b);
  }
  constexpr std::uint32_t none = ~std::uint32_t{0};
  island_of_.assign(states_.size(), none);
  island_begin_.assign(1, 0);
  const auto body_of = [&](const ContactBlock& block) { return find(block.moves_a ? block.a : block.b); };
  for (const ContactBlock& block : blocks_) {
    std::uint32_t& island = island_of_[body_of(block)];
    if (island == none) island = static_cast<std::uint32_t>(island_begin_.size() - 1), island_begin_.push_back(0);
    ++island_begin_[island + 1];
  }
  for (std::size_t i = 1; i < island_begin_.size(); ++i) island_begin_[i] += island_begin_[i - 1];
  island_blocks_.resize(blocks_.size());
  std::vector<std::uint32_t> next(island_begin_.begin(), island_begin_.end());
  for (std::uint32_t c = 0; c < blocks_.size(); ++c) island_blocks_[next[island_of_[body_of(blocks_[c])]]++] = c;
}

double ContactSolver::sweep(std::size_t island, bool forward) {
  const std::uint32_t begin = island_begin_[island], end = island_begin_[island + 1];
  double change = 0;
  if (forward)
    for (std::uint32_t k = begin; k < end; ++k)
      change = max(change, sweep_block(blocks_[island_blocks_[k]], states_, inner));
  else
    for (std::uint32_t k = end; k-- > begin;)
      change = max(change, sweep_block(blocks_[island_blocks_[k]], states_, inner));
  return change;
}

void add6(double* A, const Vec3d& r, const Vec3d& n, const Vec3d& s, const Vec3d& m, double k) {
  const Vec3d c = cross(r, n), d = cross(s, m);
  const double v[6] = {n.x, n.y, n.z, c.x, c.y, c.z}, w[6] = {m.x, m.y, m.z, d.x, d.y, d.z};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) A[i * 6 + j] += k * v[i] * w[j];
}
void add6(double* x, const Vec3d& r, const Vec3d& f) {
  const Vec3d c = cross(r, f);
  x[0] += f.x, x[1] += f.y, x[2] += f.z, x[3] += c.x, x[4] += c.y, x[5] += c.z;
}

bool ContactSolver::newton(std::size_t island) {
  ++n_newton;
  const std::uint32_t begin = island_begin_[island], end = island_begin_[island + 1];
  Work& w = work_[island];
  auto& M = w.matrix;
  const std::size_t n = w.bodies.size();
  M.clear(), w.x.assign(n * 6, 0.0);
  const auto for_each = [&](const auto& f) {
    for (std::uint32_t k = begin; k < end; ++k) {
      ContactBlock& block = blocks_[island_blocks_[k]];
      for (std::uint32_t r = 0; r < block.count; ++r) f(block, block.rows[r]);
    }
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    double* D = M.at(M.place(i, i).offset);
    for (int k = 0; k < 3; ++k) D[k * 7] = 1 / states_[w.bodies[i]].inverse_mass;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) D[(r + 3) * 6 + c + 3] = inertia_[w.bodies[i]](r, c);
  }
  const auto sticks = [](const ContactBlock& block, const ContactRow& row) {
    const double l = block.kinetic_friction * row.normal * (1 - 1e-9);
    return row.tangent[0] * row.tangent[0] + row.tangent[1] * row.tangent[1] < l * l;
  };
  for (std::uint32_t k = begin; k < end; ++k) {
    ContactBlock& block = blocks_[island_blocks_[k]];
    const ContactBody &a = states_[block.a], &b = states_[block.b];
    double* DA = block.moves_a ? M.at(M.place(local_[block.a], local_[block.a]).offset) : nullptr;
    double* DB = block.moves_b ? M.at(M.place(local_[block.b], local_[block.b]).offset) : nullptr;
    joint::BlockCholesky::Place place{};
    if (DA && DB) place = M.place(local_[block.a], local_[block.b]);
    for (std::uint32_t r = 0; r < block.count; ++r) {
      ContactRow& row = block.rows[r];
      row.base = {row.normal, row.tangent[0], row.tangent[1]}, row.du = {};
      if (!(row.normal > 0)) continue;
      const Vec3d u = a.correction_at(row.r_a) - b.correction_at(row.r_b);
      row.u = {row.C + dot(block.n, u) + (row.normal - row.last[0]) * row.normal_softness,
               row.slip[0] + dot(block.t0, u) + (row.tangent[0] - row.last[1]) * row.tangent_softness,
               row.slip[1] + dot(block.t1, u) + (row.tangent[1] - row.last[2]) * row.tangent_softness};
      const auto add = [&](const Vec3d& d, double stiffness, double residual) {
        if (DA) add6(DA, row.r_a, d, row.r_a, d, stiffness), add6(&w.x[local_[block.a] * 6], row.r_a, d * (-stiffness * residual));
        if (DB) add6(DB, row.r_b, d, row.r_b, d, stiffness), add6(&w.x[local_[block.b] * 6], row.r_b, d * (stiffness * residual));
        if (DA && DB) {
          double* O = M.at(place.offset);
          if (place.swapped) add6(O, row.r_b, d, row.r_a, d, -stiffness);
          else add6(O, row.r_a, d, row.r_b, d, -stiffness);
        }
      };
      add(block.n, (1 / row.normal_softness), row.u[0]);
      if (sticks(block, row)) {
        const double kt = 1 / row.tangent_softness;
        add(block.t0, kt, row.u[1]), add(block.t1, kt, row.u[2]);
      }
    }
  }
  M.factorize();
  M.solve(w.x);
  const auto vec = [](const double* x) { return Vec3d{x[0], x[1], x[2]}; };
  double ratio = 1;
  for_each([&](ContactBlock& block, ContactRow& row) {
    if (!(row.normal > 0)) return;
    Vec3d u{};
    if (block.moves_a) u += vec(&w.x[local_[block.a] * 6]) + cross(vec(&w.x[local_[block.a] * 6 + 3]), row.r_a);
    if (block.moves_b) u -= vec(&w.x[local_[block.b] * 6]) + cross(vec(&w.x[local_[block.b] * 6 + 3]), row.r_b);
    row.du[0] = -1 / row.normal_softness * (row.u[0] + dot(block.n, u));
    if (row.du[0] < 0) ratio = min(ratio, -row.normal / row.du[0]);
    if (!sticks(block, row)) return;
    const double kt = 1 / row.tangent_softness;
    row.du[1] = -kt * (row.u[1] + dot(block.t0, u)), row.du[2] = -kt * (row.u[2] + dot(block.t1, u));
  });
  const auto apply = [&](double alpha) {
    for (const std::uint32_t body : w.bodies) states_[body].dx = states_[body].dtheta = {};
    double f = 0;
    for_each([&](ContactBlock& block, ContactRow& row) {
      const double normal = max(row.base[0] + alpha * row.du[0], 0.0);
      double p0 = row.base[1] + alpha * row.du[1], p1 = row.base[2] + alpha * row.du[2];
      const double size2 = p0 * p0 + p1 * p1, limit = block.static_friction * normal;
      if (size2 > limit * limit) {
        const double scale = block.kinetic_friction * normal / std::sqrt(size2);
        p0 *= scale, p1 *= scale;
      }
      row.normal = normal, row.tangent = {p0, p1};
      const Vec3d P = block.n * normal + block.t0 * p0 + block.t1 * p1;
      if (block.moves_a) states_[block.a].push(row.r_a, P);
      if (block.moves_b) states_[block.b].push(row.r_b, -P);
      const double d0 = normal - row.last[0], d1 = p0 - row.last[1], d2 = p1 - row.last[2];
      f += row.C * normal + row.slip[0] * p0 + row.slip[1] * p1 + 0.5 * (d0 * d0 * row.normal_softness + (d1 * d1 + d2 * d2) * row.tangent_softness);
    });
    for (const std::uint32_t body : w.bodies) {
      const ContactBody& s = states_[body];
      f += 0.5 * (length_squared(s.dx) / s.inverse_mass + dot(s.dtheta, inertia_[body] * s.dtheta));
    }
    return f;
  };
  const double before = apply(0);
  double alpha = 1;
  for (int trial = 0; trial < trials; ++trial, alpha *= 0.4)
    if (apply(alpha) < before) return true;
  ++n_failed;
  if (apply(ratio * 0.99) < before) return true;
  apply(0);
  return false;
}

void ContactSolver::solve_island(std::size_t island, const RigidSubstep& substep) {
  const std::uint32_t begin = island_begin_[island], end = island_begin_[island + 1];
  const double limit = tolerance * substep.bounce_speed * substep.h / 2;
  long count = 0;
  double change = 0;
  const auto sweeps = [&](long n) {
    for (long i = 0; i < n; ++i) {
      ++count;
      change = sweep(island, i % 2 == 0);
      if (change <= limit) break;
    }
  };
  sweeps(pre);
  if (change > limit && newtons > 0) {
    Work& w = work_[island];
    w.bodies.clear(), w.pairs.clear();
    const auto add = [&](std::uint32_t body) {
      if (local_[body] == ~0u) local_[body] = static_cast<std::uint32_t>(w.bodies.size()), w.bodies.push_back(body);
    };
    for (std::uint32_t k = begin; k < end; ++k) {
      const ContactBlock& block = blocks_[island_blocks_[k]];
      if (block.moves_a) add(block.a);
      if (block.moves_b) add(block.b);
      if (block.moves_a && block.moves_b) w.pairs.push_back(std::minmax(local_[block.a], local_[block.b]));
    }
    std::sort(w.pairs.begin(), w.pairs.end());
    w.pairs.erase(std::unique(w.pairs.begin(), w.pairs.end()), w.pairs.end());
    if (w.bodies.size() <= 256) {
      w.matrix.analyze(std::vector<int>(w.bodies.size(), 6), w.pairs);
      if (w.matrix.cost() <= cost_limit)
        for (long i = 0; i < newtons && change > limit; ++i) {
          const double before = change;
          (void)newton(island);
          sweeps(post);
          if (getenv("DBG")) printf("newton %ld: change %.3e -> %.3e limit %.3e\n", i, before, change, limit);
        }
    }
  }
  while (change > limit && count < cap) sweeps(2);
  long points = 0;
  for (std::uint32_t k = begin; k < end; ++k) points += blocks_[island_blocks_[k]].count;
  n_sweeps += count, max_sweeps = std::max(max_sweeps, count), ++n_islands, n_points += points, n_sweep_points += points * count;
}

void ContactSolver::keep(RigidContact& contact, const ContactBlock& block) const {
  for (std::uint32_t k = 0; k < contact.count; ++k) {
    const ContactRow& row = block.rows[k];
    RigidContactPoint& point = contact.points[k];
    point.normal_impulse = row.normal;
    const bool pushes = row.normal > 0;
    point.tangent_impulse = pushes ? block.t0 * row.tangent[0] + block.t1 * row.tangent[1] : Vec3d{};
    const double size2 = row.tangent[0] * row.tangent[0] + row.tangent[1] * row.tangent[1];
    const double edge = block.kinetic_friction * row.normal * (1 - 1e-9);
    point.slid = !pushes || size2 >= edge * edge;
  }
}

void ContactSolver::solve(std::span<RigidContact> contacts, RigidBodies& bodies, const RigidSubstep& substep,
                          Threads& threads) {
  (void)threads;
  read_bodies(bodies);
  blocks_.clear();
  for (std::uint32_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].count == 0) continue;
    blocks_.emplace_back().contact = c;
  }
  for (ContactBlock& block : blocks_) linearize(contacts[block.contact], block, bodies, substep);
  find_islands();
  for (ContactBlock& block : blocks_)
    for (std::uint32_t k = 0; k < block.count; ++k) {
      ContactRow& row = block.rows[k];
      const Vec3d P = block.n * row.normal + block.t0 * row.tangent[0] + block.t1 * row.tangent[1];
      if (block.moves_a) states_[block.a].push(row.r_a, P);
      if (block.moves_b) states_[block.b].push(row.r_b, -P);
    }
  ++n_substeps;
  work_.resize(std::max(work_.size(), island_begin_.size())); local_.assign(states_.size(), ~0u); inertia_.resize(states_.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) if (bodies.mass[i].inverse > 0) inertia_[i] = inverse(bodies.inverse_inertia[i]);
  for (std::size_t i = 0; i + 1 < island_begin_.size(); ++i) solve_island(i, substep);
  for (const ContactBlock& block : blocks_) keep(contacts[block.contact], block);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!(bodies.mass[i].inverse > 0)) continue;
    bodies.pose[i].position += states_[i].dx;
    bodies.pose[i].rotation = turned(bodies.pose[i].rotation, states_[i].dtheta);
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
  return impacts_.bytes() + bytes_of(states_, blocks_, root_, island_of_, island_begin_, island_blocks_);
}

}  // namespace souple
