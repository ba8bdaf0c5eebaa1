#include "souple/rigid/contact_newton.h"

#include "souple/state/bytes.h"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};

/// What a unit impulse along d at r pushes: force and moment.
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
template <class Blocks, class Function>
void for_each_row(Blocks blocks, std::span<const std::uint32_t> island, const Function& f) {
  for (std::size_t i = 0; i < island.size(); ++i)
    for (std::uint32_t k = 0; k < blocks[island[i]].count; ++k)
      f(blocks[island[i]], blocks[island[i]].rows[k], i * 4 + k);
}

}  // namespace

void ContactNewton::prepare(std::span<const ContactBlock> blocks, std::span<const std::uint32_t> island,
                            std::span<std::uint32_t> local) {
  for (const std::uint32_t i : island) {
    if (blocks[i].moves_a) local[blocks[i].a] = none;
    if (blocks[i].moves_b) local[blocks[i].b] = none;
  }
  bodies_.clear(), pairs_.clear();
  const auto add = [&](std::uint32_t body) {
    if (local[body] == none)
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
  if (last_bodies_ == bodies_.size() && pairs_ == last_pairs_) return;
  last_bodies_ = bodies_.size(), last_pairs_ = pairs_;
  matrix_.analyze(static_cast<std::uint32_t>(bodies_.size()), pairs_);
  cost_ = matrix_.cost();
}

void ContactNewton::add_row(const ContactBlock& block, const ContactRow& row,
                            std::span<const std::uint32_t> local, std::span<const ContactBody> states) {
  const ContactVector residual = block.residual(states, row);
  BodyMatrix::Block* const a = block.moves_a ? &matrix_.diagonal(local[block.a]) : nullptr;
  BodyMatrix::Block* const b = block.moves_b ? &matrix_.diagonal(local[block.b]) : nullptr;
  const std::size_t axes = block.sticks(row) ? 3 : 1;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double k = 1 / (axis == 0 ? row.normal_softness : row.tangent_softness);
    const std::array<double, 6> J_a = wrench(row.r_a, block.axes[axis]),
                                J_b = wrench(row.r_b, block.axes[axis]);
    if (a) add_product(*a, J_a, J_a, k);
    if (b) add_product(*b, J_b, J_b, k);
    if (a && b) {
      const auto [beside, swapped] = matrix_.beside(local[block.a], local[block.b]);
      add_product(*beside, swapped ? J_b : J_a, swapped ? J_a : J_b, -k);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      if (a) motion_[std::size_t{local[block.a]} * 6 + i] -= J_a[i] * k * residual[axis];
      if (b) motion_[std::size_t{local[block.b]} * 6 + i] += J_b[i] * k * residual[axis];
    }
  }
}

void ContactNewton::assemble(std::span<const ContactBlock> blocks, std::span<const std::uint32_t> island,
                             std::span<const std::uint32_t> local, std::span<const ContactBody> states) {
  matrix_.clear();
  motion_.assign(bodies_.size() * 6, 0.0);
  inertia_.resize(bodies_.size());
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    inertia_[i] = inertia_of(states[bodies_[i]]);
    BodyMatrix::Block& D = matrix_.diagonal(i);
    for (std::size_t k = 0; k < 3; ++k) D[k * 7] = 1 / states[bodies_[i]].inverse_mass;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        D[static_cast<std::size_t>((row + 3) * 6 + column + 3)] = inertia_[i](row, column);
  }
  for_each_row(blocks, island, [&](const ContactBlock& block, const ContactRow& row, std::size_t) {
    if (row.impulse[0] > 0) add_row(block, row, local, states);
  });
}

void ContactNewton::find_changes(std::span<const ContactBlock> blocks, std::span<const std::uint32_t> island,
                                 std::span<const std::uint32_t> local, std::span<const ContactBody> states) {
  const auto motion_at = [&](std::uint32_t body, const Vec3d& r) {
    const double* const q = &motion_[std::size_t{local[body]} * 6];
    return Vec3d{q[0], q[1], q[2]} + cross(Vec3d{q[3], q[4], q[5]}, r);
  };
  changes_.assign(island.size() * 4, {});
  for_each_row(blocks, island, [&](const ContactBlock& block, const ContactRow& row, std::size_t at) {
    Change& change = changes_[at];
    change.before = row.impulse;
    if (!(row.impulse[0] > 0)) return;
    const ContactVector residual = block.residual(states, row);
    Vec3d u{};
    if (block.moves_a) u += motion_at(block.a, row.r_a);
    if (block.moves_b) u -= motion_at(block.b, row.r_b);
    const ContactVector du = block.along_axes(u);
    change.step[0] = -(residual[0] + du[0]) / row.normal_softness;
    if (!block.sticks(row)) return;
    change.step[1] = -(residual[1] + du[1]) / row.tangent_softness;
    change.step[2] = -(residual[2] + du[2]) / row.tangent_softness;
  });
}

// The energy is |q|^2_M / 2 + gap . p + softness |p|^2 / 2: without friction, contacts minimize it.
double ContactNewton::apply(double part, std::span<ContactBlock> blocks,
                            std::span<const std::uint32_t> island, std::span<ContactBody> states) const {
  for (const std::uint32_t body : bodies_) states[body].dx = states[body].dtheta = {};
  double energy = 0;
  for_each_row(blocks, island, [&](ContactBlock& block, ContactRow& row, std::size_t at) {
    const auto& [p, d] = changes_[at];
    row.impulse = block.within_limits({p[0] + part * d[0], p[1] + part * d[1], p[2] + part * d[2]});
    block.push(states, row, block.in_world(row.impulse));
    energy += row.gap[0] * row.impulse[0] + row.normal_softness * row.impulse[0] * row.impulse[0] / 2;
    for (const std::size_t k : {1u, 2u})
      energy += row.gap[k] * row.impulse[k] + row.tangent_softness * row.impulse[k] * row.impulse[k] / 2;
  });
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const ContactBody& body = states[bodies_[i]];
    energy += (length_squared(body.dx) / body.inverse_mass + dot(body.dtheta, inertia_[i] * body.dtheta)) / 2;
  }
  return energy;
}

bool ContactNewton::step(std::span<ContactBlock> blocks, std::span<const std::uint32_t> island,
                         std::span<const std::uint32_t> local, std::span<ContactBody> states) {
  assemble(blocks, island, local, states);
  matrix_.factorize();
  matrix_.solve(motion_);
  find_changes(blocks, island, local, states);
  const double before = apply(0, blocks, island, states);
  for (const double part : {1.0, 0.4, 0.16, 0.064})
    if (apply(part, blocks, island, states) < before) return true;
  apply(0, blocks, island, states);
  return false;
}

std::size_t ContactNewton::bytes() const {
  return matrix_.bytes() + bytes_of(bodies_, pairs_, last_pairs_, inertia_, motion_, changes_);
}

}  // namespace souple
