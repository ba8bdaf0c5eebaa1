#include "souple/rigid/contact_newton.h"

#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {
namespace {

/// Force and moment of a unit impulse along d at r.
std::array<double, 6> wrench(const Vec3d& r, const Vec3d& d) {
  const Vec3d m = cross(r, d);
  return {d.x, d.y, d.z, m.x, m.y, m.z};
}

void add_product(BodyMatrix::Block& A, const std::array<double, 6>& v, const std::array<double, 6>& w,
                 double k) {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) A[i * 6 + j] += k * v[i] * w[j];
}

Mat3d inertia_of(const ContactBody& body) {
  const Vec3d &d = body.inertia_diagonal, &o = body.inertia_rest;
  return inverse(Mat3d{{d.x, o.z, o.y}, {o.z, d.y, o.x}, {o.y, o.x, d.z}});
}

/// Visits the rows of an island with their number, four a contact.
template <class Function>
void for_each_row(const ContactSystem& system, const Function& f) {
  for (std::size_t i = 0; i < system.island.size(); ++i) {
    ContactBlock& block = system.blocks[system.island[i]];
    for (std::uint32_t k = 0; k < block.count; ++k) f(block, block.rows[k], i * 4 + k);
  }
}

/// Relative motion at a point of a contact, for motions q of the bodies, six numbers a body.
Vec3d motion_between(const ContactSystem& system, const ContactBlock& block, const ContactRow& row,
                     std::span<const double> q) {
  const auto motion_at = [&](std::uint32_t body, const Vec3d& r) {
    const double* const m = &q[std::size_t{system.local[body]} * 6];
    return Vec3d{m[0], m[1], m[2]} + cross(Vec3d{m[3], m[4], m[5]}, r);
  };
  Vec3d u{};
  if (block.moves_a) u += motion_at(block.a, row.r_a);
  if (block.moves_b) u -= motion_at(block.b, row.r_b);
  return u;
}

/// y += J^T p.
void add_push(const ContactSystem& system, const ContactBlock& block, const ContactRow& row, const Vec3d& p,
              std::span<double> y) {
  const auto add = [&](std::uint32_t body, const Vec3d& r, const Vec3d& push) {
    double* const f = &y[std::size_t{system.local[body]} * 6];
    const Vec3d m = cross(r, push);
    f[0] += push.x, f[1] += push.y, f[2] += push.z, f[3] += m.x, f[4] += m.y, f[5] += m.z;
  };
  if (block.moves_a) add(block.a, row.r_a, p);
  if (block.moves_b) add(block.b, row.r_b, -p);
}

double inner_product(std::span<const double> x, std::span<const double> y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

}  // namespace

void ContactNewton::prepare(const ContactSystem& system) {
  const std::span<ContactBlock> blocks = system.blocks;
  const std::span<const std::uint32_t> island = system.island;
  const std::span<std::uint32_t> local = system.local;
  for (const std::uint32_t i : island) {
    if (blocks[i].moves_a) local[blocks[i].a] = no_index;
    if (blocks[i].moves_b) local[blocks[i].b] = no_index;
  }
  bodies_.clear(), pairs_.clear();
  const auto add = [&](std::uint32_t body) {
    if (local[body] == no_index)
      local[body] = static_cast<std::uint32_t>(bodies_.size()), bodies_.push_back(body);
  };
  for (const std::uint32_t i : island) {
    const ContactBlock& block = blocks[i];
    if (block.moves_a) add(block.a);
    if (block.moves_b) add(block.b);
    if (block.moves_a && block.moves_b) pairs_.push_back(std::minmax(local[block.a], local[block.b]));
  }
  if (bodies_.size() > BodyMatrix::most_bodies) {
    cost_ = std::numeric_limits<double>::infinity();
    return;
  }
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  if (bodies_ != last_bodies_ || island.size() * 4 != rows_.size()) factored_ = false;
  const bool same = last_bodies_.size() == bodies_.size() && pairs_ == last_pairs_;
  last_bodies_ = bodies_;
  if (!same) {
    last_pairs_ = pairs_, factored_ = false;
    matrix_.analyze(static_cast<std::uint32_t>(bodies_.size()), pairs_);
  }
  cost_ = matrix_.cost();
}

// Starts with the phases of the last sweep. The springs' own phases would be worse, because springs magnify the errors
// of a sweep.
void ContactNewton::begin(const ContactSystem& system) {
  const std::size_t unknowns = bodies_.size() * 6;
  for (std::vector<double>* const v : {&motion_, &residual_, &solution_, &direction_, &image_, &smoothed_})
    v->resize(unknowns);
  inertia_.resize(bodies_.size());
  rows_.resize(system.island.size() * 4);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const ContactBody& body = system.states[bodies_[i]];
    inertia_[i] = inertia_of(body);
    for (int k = 0; k < 3; ++k) {
      motion_[i * 6 + static_cast<std::size_t>(k)] = body.dx[k];
      motion_[i * 6 + 3 + static_cast<std::size_t>(k)] = body.dtheta[k];
    }
  }
  for_each_row(system, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    Row& r = rows_[at];
    const ContactVector u = block.along_axes(motion_between(system, block, row, motion_));
    r.gap = {row.gap[0] + u[0], row.gap[1] + u[1], row.gap[2] + u[2]};
    r.before = r.slide = row.impulse;
    const bool sticks = block.sticks(row);
    r.phase = !(row.impulse[0] > 0) ? Phase::apart : sticks ? Phase::sticks : Phase::slides;
    r.hold = sticks ? block.static_friction : block.kinetic_friction;
    r.limit = block.kinetic_friction * row.impulse[0], r.across = 0;
  });
}

void ContactNewton::multiply_mass(const ContactSystem& system, std::span<const double> x,
                                  std::span<double> y) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const double m = 1 / system.states[bodies_[i]].inverse_mass;
    const double* const q = &x[i * 6];
    const Vec3d L = inertia_[i] * Vec3d{q[3], q[4], q[5]};
    const std::array<double, 6> product{m * q[0], m * q[1], m * q[2], L.x, L.y, L.z};
    std::copy(product.begin(), product.end(), y.begin() + static_cast<std::ptrdiff_t>(i * 6));
  }
}

void ContactNewton::find_residual(const ContactSystem& system) {
  multiply_mass(system, motion_, residual_);
  for (double& r : residual_) r = -r;
  for_each_row(system, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    const Row& r = rows_[at];
    if (r.phase == Phase::apart) return;
    const ContactVector p = impulse_of(row, r);
    add_push(system, block, row, block.in_world(p), residual_);
  });
}

void ContactNewton::multiply(const ContactSystem& system, std::span<const double> x,
                             std::span<double> y) const {
  multiply_mass(system, x, y);
  for_each_row(system, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    const Row& r = rows_[at];
    if (r.phase == Phase::apart) return;
    const Vec3d u = motion_between(system, block, row, x);
    Vec3d p{};
    for_each_spring(block, row, r, [&](const Vec3d& axis, double k) { p += axis * (k * dot(axis, u)); });
    add_push(system, block, row, p, y);
  });
}

void ContactNewton::assemble(const ContactSystem& system) {
  matrix_.clear();
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    BodyMatrix::Block& D = matrix_.diagonal(i);
    for (std::size_t k = 0; k < 3; ++k) D[k * 7] = 1 / system.states[bodies_[i]].inverse_mass;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        D[static_cast<std::size_t>((row + 3) * 6 + column + 3)] = inertia_[i](row, column);
  }
  for_each_row(system, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    Row& r = rows_[at];
    r.factored = r.phase;
    if (r.phase == Phase::apart) return;
    for_each_spring(block, row, r, [&](const Vec3d& axis, double k) {
      const std::array<double, 6> J_a = wrench(row.r_a, axis), J_b = wrench(row.r_b, axis);
      if (block.moves_a) add_product(matrix_.diagonal(system.local[block.a]), J_a, J_a, k);
      if (block.moves_b) add_product(matrix_.diagonal(system.local[block.b]), J_b, J_b, k);
      if (!block.moves_a || !block.moves_b) return;
      const auto [beside, swapped] = matrix_.beside(system.local[block.a], system.local[block.b]);
      add_product(*beside, swapped ? J_b : J_a, swapped ? J_a : J_b, -k);
    });
  });
}

// Conjugate gradients with the factor of other phases: each row that changed its phase takes about one iteration.
bool ContactNewton::solve_with_kept_factor(const ContactSystem& system, int iterations) {
  constexpr double tolerance = 1e-5, enough = 1e-2;
  std::fill(solution_.begin(), solution_.end(), 0.0);
  double last = 0, first = 0;
  for (int i = 0; i <= iterations; ++i) {
    smoothed_ = residual_;
    matrix_.solve(smoothed_);
    const double square = inner_product(residual_, smoothed_);
    if (i == 0) first = square;
    if (square <= first * (tolerance * tolerance)) return true;
    const double keep = i == 0 ? 0 : square / last;
    for (std::size_t k = 0; k < direction_.size(); ++k)
      direction_[k] = smoothed_[k] + (i == 0 ? 0 : keep * direction_[k]);
    multiply(system, direction_, image_);
    const double length = square / inner_product(direction_, image_);
    for (std::size_t k = 0; k < solution_.size(); ++k)
      solution_[k] += length * direction_[k], residual_[k] -= length * image_[k];
    last = square;
  }
  return last <= first * (enough * enough);
}

bool ContactNewton::solve(const ContactSystem& system, double& budget) {
  const double once = matrix_.solve_cost() + static_cast<double>(rows_.size()) * 100;
  if (factored_) {
    int changed = 0;
    for_each_row(system, [&](const ContactBlock&, const ContactRow&, std::size_t at) {
      changed += rows_[at].phase != rows_[at].factored;
    });
    const int iterations = changed + 2;
    if (iterations * once < min(cost_, budget)) {
      budget -= iterations * once;
      if (solve_with_kept_factor(system, iterations + 2)) return true;
      find_residual(system);
    }
  }
  factored_ = false;
  if (cost_ > budget) return false;
  budget -= cost_;
  assemble(system);
  matrix_.factorize();
  factored_ = true;
  solution_ = residual_;
  matrix_.solve(solution_);
  return true;
}

void ContactNewton::find_rates(const ContactSystem& system) {
  for_each_row(system, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    rows_[at].rate = block.along_axes(motion_between(system, block, row, solution_));
  });
}

// Derivative of the springs' energy along the solution, after a part of it.
double ContactNewton::slope(const ContactSystem& system, double part) const {
  double sum = 0;
  for_each_row(system, [&](const ContactBlock&, const ContactRow& row, std::size_t at) {
    const Row& r = rows_[at];
    const double C = r.gap[0] + part * r.rate[0];
    if (C < 0) sum += C * r.rate[0] / row.normal_softness;
    if (!(r.limit > 0)) return;
    const double s = (r.gap[1] + part * r.rate[1]) / row.tangent_softness;
    const double t = (r.gap[2] + part * r.rate[2]) / row.tangent_softness;
    const double size = std::sqrt(s * s + t * t);
    sum += (s * r.rate[1] + t * r.rate[2]) * (size <= r.limit ? 1 : r.limit / size);
  });
  return sum;
}

// The energy is convex: its derivative has one zero, which regula falsi finds (Illinois: Dowell and Jarratt 1971).
double ContactNewton::best_part(const ContactSystem& system) {
  constexpr int most = 24;
  constexpr double precision = 1e-6;
  multiply_mass(system, solution_, image_);
  const double m0 = inner_product(image_, motion_), m1 = inner_product(image_, solution_);
  const auto derivative = [&](double part) { return m0 + m1 * part + slope(system, part); };
  double lo = 0, hi = 1, at_lo = derivative(0), at_hi = derivative(1), part = 1;
  const double small = precision * std::abs(at_lo);
  if (at_hi <= small) return 1;
  int last = 0;
  for (int i = 0; i < most; ++i) {
    part = lo + (hi - lo) * std::clamp(-at_lo / (at_hi - at_lo), 0.02, 0.98);
    const double value = derivative(part);
    if (std::abs(value) <= small) break;
    if (value > 0) {
      hi = part, at_hi = value;
      if (last == 1) at_lo /= 2;
      last = 1;
    } else {
      lo = part, at_lo = value;
      if (last == -1) at_hi /= 2;
      last = -1;
    }
  }
  return part;
}

void ContactNewton::advance(const ContactSystem& system, double part) {
  for (std::size_t i = 0; i < motion_.size(); ++i) motion_[i] += part * solution_[i];
  for_each_row(system, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    Row& r = rows_[at];
    for (std::size_t k = 0; k < 3; ++k) r.gap[k] += part * r.rate[k];
    const double normal = max(-r.gap[0] / row.normal_softness, 0.0);
    const double s = -r.gap[1] / row.tangent_softness, t = -r.gap[2] / row.tangent_softness;
    const double size = std::sqrt(s * s + t * t);
    r.phase = !(normal > 0) ? Phase::apart : size <= r.hold * normal ? Phase::sticks : Phase::slides;
    if (r.phase == Phase::slides) {
      r.hold = block.kinetic_friction;
      const double scale = r.hold * normal / size;
      r.slide = {0, s * scale, t * scale}, r.across = scale / row.tangent_softness;
    }
    r.limit = r.hold * normal;
  });
}

// Forces of the springs and motions disagree by M^-1 (J^T p - M q): the error of ending here [m].
double ContactNewton::error(const ContactSystem& system) const {
  double square = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const ContactBody& body = system.states[bodies_[i]];
    const double* const r = &residual_[i * 6];
    const Vec3d push{r[0], r[1], r[2]}, turn{r[3], r[4], r[5]};
    const double w = body.inverse_mass;
    square = max(square, length_squared(push) * w * w + dot(turn, body.spin_of(turn)) * w);
  }
  return std::sqrt(square);
}

bool ContactNewton::iterate(const ContactSystem& system, const Limits& limits, double& budget) {
  find_residual(system);
  for (int i = 0; i < limits.solves; ++i) {
    if (!solve(system, budget)) return false;
    find_rates(system);
    const double part = i == 0 ? 1 : best_part(system);
    advance(system, part);
    find_residual(system);
    if (error(system) <= limits.error) return true;
  }
  return false;
}

void ContactNewton::find_impulses(const ContactSystem& system) {
  for_each_row(system, [&](const ContactBlock&, const ContactRow& row, std::size_t at) {
    Row& r = rows_[at];
    r.after = r.phase == Phase::apart ? ContactVector{} : impulse_of(row, r);
  });
}

// The energy is |q|^2_M / 2 + gap . p + softness |p|^2 / 2. Without friction, contacts minimize it.
double ContactNewton::apply(const ContactSystem& system, double part) const {
  for (const std::uint32_t body : bodies_) system.states[body].dx = system.states[body].dtheta = {};
  double energy = 0;
  for_each_row(system, [&](const ContactBlock& block, ContactRow& row, std::size_t at) {
    const ContactVector &p = rows_[at].before, &q = rows_[at].after;
    const auto between = [&](std::size_t k) { return p[k] + part * (q[k] - p[k]); };
    row.impulse = block.within_limits(part == 1 ? q : ContactVector{between(0), between(1), between(2)});
    block.push(system.states, row, block.in_world(row.impulse));
    energy += row.gap[0] * row.impulse[0] + row.normal_softness * row.impulse[0] * row.impulse[0] / 2;
    for (const std::size_t k : {1u, 2u})
      energy += row.gap[k] * row.impulse[k] + row.tangent_softness * row.impulse[k] * row.impulse[k] / 2;
  });
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const ContactBody& body = system.states[bodies_[i]];
    energy += (length_squared(body.dx) / body.inverse_mass + dot(body.dtheta, inertia_[i] * body.dtheta)) / 2;
  }
  return energy;
}

bool ContactNewton::step(const ContactSystem& system, const Limits& limits, double& budget) {
  begin(system);
  converged_ = iterate(system, limits, budget);
  find_impulses(system);
  const double before = converged_ ? std::numeric_limits<double>::infinity() : apply(system, 0);
  for (const double part : {1.0, 0.4, 0.16, 0.064})
    if (apply(system, part) < before) return true;
  apply(system, 0);
  return false;
}

std::size_t ContactNewton::bytes() const {
  return matrix_.bytes() + bytes_of(bodies_, last_bodies_, pairs_, last_pairs_, inertia_, motion_, residual_,
                                    solution_, direction_, image_, smoothed_, rows_);
}

}  // namespace souple
