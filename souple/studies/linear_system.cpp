#include "souple/studies/linear_system.h"

#include "souple/assert.h"
#include "souple/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

// Strain of a rigid constraint of the primal system that carries the weight of the whole scene, under 9.81
// m/s^2. Ten times less still factorizes in double (the condition number of a 50 x 50 cloth is 1e6). But then the
// errors of an inexact linearization act with more force.
constexpr double floor_strain = 1e-5;
constexpr double gravity = 9.81;
// Upper bound of the violation that the floor leaves of an isolated constraint, as a fraction, however light
// the scene.
constexpr double floor_ratio = 1e-6;

// The inverse of a symmetric positive definite matrix, packed lower, by Gauss-Jordan elimination.
void invert_packed(int n, const double* a, double* result) {
  if (n == 1) {
    result[0] = 1 / a[0];
    return;
  }
  double m[LinearSystem::max_rows][2 * LinearSystem::max_rows] = {};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) m[i][j] = a[packed_index(i, j)];
    m[i][n + i] = 1;
  }
  for (int i = 0; i < n; ++i) {
    SOUPLE_ASSERT(m[i][i] > 0, "the matrix is positive definite");
    const double pivot = 1 / m[i][i];
    for (int j = 0; j < 2 * n; ++j) m[i][j] *= pivot;
    for (int k = 0; k < n; ++k) {
      if (k == i) continue;
      const double factor = m[k][i];
      for (int j = 0; j < 2 * n; ++j) m[k][j] -= factor * m[i][j];
    }
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) result[packed_index(i, j)] = m[i][n + j];
}

double shortest_distance(std::span<const std::uint32_t> members, const ParticleView& particles) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < members.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double l = length(Vec3d(particles.difference(members[i], members[j])));
      if (l > 0) shortest = std::min(shortest, l);
    }
  return shortest;
}

}  // namespace

void LinearSystem::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  *this = {};
  unknown_of_.assign(particles.position.size(), pinned);
  double weight = 0;
  smallest_size_ = std::numeric_limits<double>::infinity();
  for (Projector* projector : projectors)
    if (const LinearFacet* const linear = projector->facets().linear) {
      linear->linearize(particles, Substep{.h = 1},
                        [&](const LinearConstraint& constraint) { add_structure(constraint, particles); });
      linear_.push_back(linear);
    }
  // No distance as a reference (attachments alone): use a meter.
  if (!std::isfinite(smallest_size_)) smallest_size_ = 1;
  for (Block& block : blocks_)
    if (!std::isfinite(block.size)) block.size = smallest_size_;
  for (const double m : mass) weight += m * gravity;
  if (weight > 0) floor_ = floor_strain / weight;
  inverse.assign(compliance.size(), 0);
  lambda.assign(b.size(), 0);
  dlambda.assign(b.size(), 0);
  dx.assign(unknowns(), {});
}

void LinearSystem::add_structure(const LinearConstraint& constraint, const ParticleView& particles) {
  const std::size_t rows = constraint.C.size(), arity = constraint.particles.size();
  if (rows > max_rows)
    throw Error(fmt::format(
        "a constraint couples {} rows, the linear solvers take at most {}: use the solver gauss_seidel", rows,
        max_rows));
  const double size = shortest_distance(constraint.particles, particles);
  smallest_size_ = std::min(smallest_size_, size);
  blocks_.push_back({static_cast<std::uint32_t>(b.size()), static_cast<std::uint32_t>(unknown.size()),
                     static_cast<std::uint32_t>(gradient.size()),
                     static_cast<std::uint32_t>(compliance.size()), static_cast<std::uint16_t>(rows),
                     static_cast<std::uint16_t>(arity), constraint.inequality, false, size});
  for (const std::uint32_t particle : constraint.particles) {
    const double w = static_cast<double>(particles.inverse_mass(particle));
    if (w > 0 && unknown_of_[particle] == pinned) {
      unknown_of_[particle] = static_cast<std::uint32_t>(particle_of.size());
      particle_of.push_back(particle);
      mass.push_back(1 / w);
    }
    unknown.push_back(unknown_of_[particle]);
  }
  gradient.resize(gradient.size() + rows * arity);
  compliance.resize(compliance.size() + rows * (rows + 1) / 2);
  b.resize(b.size() + rows);
}

void LinearSystem::begin_substep() {
  std::fill(lambda.begin(), lambda.end(), 0.0);
}

void LinearSystem::linearize(const ParticleView& particles, const Substep& substep, bool floor) {
  struct Context {
    LinearSystem& system;
    double inverse_h2;
    bool floor;
    std::size_t next = 0;
  } context{*this, 1 / (static_cast<double>(substep.h) * static_cast<double>(substep.h)), floor};
  floored_ = 0;
  for (const LinearFacet* linear : linear_)
    linear->linearize(particles, substep, [&context](const LinearConstraint& constraint) {
      Block& block = context.system.blocks_[context.next++];
      context.system.fill(block, constraint);
      if (context.floor && !block.inactive) context.system.raise_to_floor(block, context.inverse_h2);
    });
}

void LinearSystem::fill(Block& block, const LinearConstraint& constraint) {
  block.inactive = false;
  double gradient_squared = 0;
  const auto of = members(block);
  std::copy(constraint.gradient.begin(), constraint.gradient.end(), gradient.data() + block.gradient);
  for (int r = 0; r < block.rows; ++r)
    for (std::size_t k = 0; k < block.arity; ++k)
      if (of[k] != pinned) gradient_squared += length_squared(Vec3d(gradient_of(block, r)[k]));
  const bool satisfied = block.inequality && constraint.C[0] >= 0;
  if (satisfied || !(gradient_squared > 0)) return deactivate(block);
  const double scale = static_cast<double>(constraint.scale);
  double* A = &compliance[block.compliance];
  for (std::size_t k = 0; k < constraint.alpha.size(); ++k) A[k] = static_cast<double>(constraint.alpha[k]);
  for (int r = 0; r < block.rows; ++r)
    b[block.row + static_cast<std::size_t>(r)] =
        -scale * static_cast<double>(constraint.C[static_cast<std::size_t>(r)]) -
        row_times(block.rows, A, r, &lambda[block.row]);
}

void LinearSystem::raise_to_floor(const Block& block, double inverse_h2) {
  for (int r = 0; r < block.rows; ++r) {
    double steepest = 0, weighted = 0;
    const auto of = members(block);
    for (std::size_t k = 0; k < block.arity; ++k) {
      const double squared = length_squared(Vec3d(gradient_of(block, r)[k]));
      steepest = std::max(steepest, squared);
      if (of[k] != pinned) weighted += squared / mass[of[k]];
    }
    const double floor = std::min(floor_ * block.size * steepest * inverse_h2, floor_ratio * weighted);
    double& diagonal = compliance[block.compliance + packed_index(r, r)];
    // A row without a gradient moves nothing, but must not make A singular.
    if (weighted == 0 && diagonal == 0) diagonal = 1;
    if (diagonal >= floor) continue;
    diagonal = floor;
    ++floored_;
  }
}

void LinearSystem::deactivate(Block& block) {
  block.inactive = true;
  const std::size_t rows = block.rows;
  std::fill_n(gradient.data() + block.gradient, rows * block.arity, Vec3f{});
  std::fill_n(compliance.data() + block.compliance, rows * (rows + 1) / 2, 0.0);
  for (int r = 0; r < block.rows; ++r) compliance[block.compliance + packed_index(r, r)] = 1;
  std::fill_n(b.data() + block.row, rows, 0.0);
}

void LinearSystem::invert_compliance() {
  for (const Block& block : blocks_)
    invert_packed(block.rows, &compliance[block.compliance], &inverse[block.compliance]);
}

void LinearSystem::moves_from_multipliers() {
  std::fill(dx.begin(), dx.end(), Vec3d{});
  for (const Block& block : blocks_) {
    const auto of = members(block);
    for (int r = 0; r < block.rows; ++r)
      for (std::size_t k = 0; k < block.arity; ++k)
        if (of[k] != pinned)
          dx[of[k]] += Vec3d(gradient_of(block, r)[k]) *
                       (dlambda[block.row + static_cast<std::size_t>(r)] / mass[of[k]]);
  }
}

void LinearSystem::multipliers_from_moves() {
  for (const Block& block : blocks_) {
    double left[max_rows];
    const auto of = members(block);
    for (int r = 0; r < block.rows; ++r) {
      left[r] = b[block.row + static_cast<std::size_t>(r)];
      for (std::size_t k = 0; k < block.arity; ++k)
        if (of[k] != pinned) left[r] -= dot(Vec3d(gradient_of(block, r)[k]), dx[of[k]]);
    }
    for (int r = 0; r < block.rows; ++r)
      dlambda[block.row + static_cast<std::size_t>(r)] =
          row_times(block.rows, &inverse[block.compliance], r, left);
  }
}

bool LinearSystem::deactivate_pulling() {
  bool dropped = false;
  for (Block& block : blocks_) {
    if (!block.inequality || block.inactive) continue;
    // Tolerance: rounding alone does not count as pulling.
    const double bound = -1e-9 * std::fabs(lambda[block.row]);
    if (lambda[block.row] + dlambda[block.row] >= bound) continue;
    deactivate(block);
    std::fill_n(dlambda.data() + block.row, block.rows, 0.0);
    dropped = true;
  }
  return dropped;
}

double LinearSystem::violation() const {
  double sum = 0;
  for (const Block& block : blocks_)
    for (int r = 0; r < block.rows; ++r)
      sum += 0.5 * b[block.row + static_cast<std::size_t>(r)] *
             row_times(block.rows, &inverse[block.compliance], r, &b[block.row]);
  return sum;
}

double LinearSystem::largest_deformation() const {
  const auto move_of = [&](std::uint32_t u) { return u == pinned ? Vec3d{} : dx[u]; };
  double largest = 0;
  for (const Block& block : blocks_) {
    const auto of = members(block);
    for (std::size_t k = 1; k < block.arity; ++k) {
      const Vec3d relative = move_of(of[k]) - move_of(of[0]);
      largest = std::max(largest, length_squared(relative) / (block.size * block.size));
    }
  }
  return std::sqrt(largest);
}

double LinearSystem::kinetic() const {
  double sum = 0;
  for (std::size_t u = 0; u < dx.size(); ++u) sum += 0.5 * mass[u] * length_squared(dx[u]);
  return sum;
}

void LinearSystem::move(const ParticleView& particles, double factor) const {
  for (std::size_t u = 0; u < dx.size(); ++u) particles.correct(particle_of[u], Vec3f(dx[u] * factor));
}

void LinearSystem::accept(double factor) {
  for (std::size_t r = 0; r < lambda.size(); ++r) lambda[r] += factor * dlambda[r];
}

}  // namespace souple
