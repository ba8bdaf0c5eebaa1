#include "souple/fluid/coarse_pressure.h"

#include "souple/assert.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple {

namespace {

constexpr int coordinate_bits = 21;

std::uint64_t node_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << coordinate_bits) - 1;
  return (static_cast<std::uint64_t>(z) & mask) << (2 * coordinate_bits) |
         (static_cast<std::uint64_t>(y) & mask) << coordinate_bits | (static_cast<std::uint64_t>(x) & mask);
}

/// K y of the unit cube; corner e is at (e & 1, e >> 1 & 1, e >> 2).
template <class Eight>
Eight element(const Eight& y) {
  const double sum = ((y[0] + y[1]) + (y[2] + y[3])) + ((y[4] + y[5]) + (y[6] + y[7]));
  Eight result;
  for (std::size_t e = 0; e < 8; ++e) {
    const double along_edges = y[e ^ 1] + y[e ^ 2] + y[e ^ 4];
    result[e] = y[e] / 3 - (sum - y[e] - along_edges) / 12;
  }
  return result;
}

}  // namespace

void CoarsePressure::begin_step(std::span<const Vec4f> positions, float cell_size, Threads& threads) {
  size_ = cell_size;
  order_.build(positions, cell_size, threads);
  find_nodes();
  cell_of_.resize(positions.size());
  threads.each(order_.cell_count(), 16, [&](std::size_t c) {
    for (std::uint32_t k = order_.cells()[c].begin; k < order_.cells()[c + 1].begin; ++k)
      cell_of_[order_.order()[k]] = static_cast<std::uint32_t>(c);
  });
  mover_count_ = 0;
}

void CoarsePressure::begin_movers(std::size_t count) {
  if (movers_.size() < count) movers_.resize(count);
  mover_count_ = count;
  for (std::size_t m = 0; m < count; ++m) {
    movers_[m].inverse_mass = 0;
    movers_[m].nodes.clear();
    movers_[m].pushes.clear();
    movers_[m].slot_of_node.assign(y_.size(), no_index);
  }
}

void CoarsePressure::set_mover(std::size_t mover, double inverse_mass, const Mat3d& inverse_inertia) {
  movers_[mover].inverse_mass = inverse_mass;
  movers_[mover].inverse_inertia = inverse_inertia;
}

void CoarsePressure::add_contact(std::size_t mover, std::uint32_t index, const Vec4f& position,
                                 const Vec3d& slope, const Vec3d& moment) {
  Mover& body = movers_[mover];
  const std::size_t cell = cell_of_[index];
  const std::array<float, 8> n = weights(cell, position);
  for (std::size_t e = 0; e < 8; ++e) {
    std::uint32_t& slot = body.slot_of_node[corners_[cell][e]];
    if (slot == no_index) {
      slot = static_cast<std::uint32_t>(body.nodes.size());
      body.nodes.push_back(corners_[cell][e]);
      body.pushes.push_back({});
    }
    body.pushes[slot].first += slope * static_cast<double>(n[e]);
    body.pushes[slot].second += moment * static_cast<double>(n[e]);
  }
}

// J^T W J y
void CoarsePressure::add_bodies(const std::vector<double>& y, std::vector<double>& result) const {
  for (std::size_t m = 0; m < mover_count_; ++m) {
    const Mover& body = movers_[m];
    Vec3d force{}, torque{};
    for (std::size_t k = 0; k < body.nodes.size(); ++k) {
      force += body.pushes[k].first * y[body.nodes[k]];
      torque += body.pushes[k].second * y[body.nodes[k]];
    }
    const Vec3d moved = force * body.inverse_mass, turned = body.inverse_inertia * torque;
    for (std::size_t k = 0; k < body.nodes.size(); ++k)
      result[body.nodes[k]] += dot(body.pushes[k].first, moved) + dot(body.pushes[k].second, turned);
  }
}

void CoarsePressure::find_nodes() {
  const auto cells = order_.cells();
  const auto rows = order_.rows();
  const std::size_t count = order_.cell_count();
  // Node keys are rounded world coordinates, so that the next step's grid, with another corner, finds the
  // same nodes.
  constexpr double farthest = 1e15;  // cells
  std::int64_t first[3];
  for (int axis = 0; axis < 3; ++axis)
    first[axis] =
        std::llround(std::clamp(order_.corner(axis) / static_cast<double>(size_), -farthest, farthest)) +
        (std::int64_t{1} << 19);
  keys_.clear();
  origin_.clear();
  for (std::size_t row = 0; row < order_.row_count(); ++row) {
    for (std::uint32_t c = rows[row].begin; c < rows[row + 1].begin; ++c) {
      const std::int32_t cell[3] = {cells[c].x, rows[row].y, rows[row].z};
      for (std::uint32_t e = 0; e < 8; ++e)
        keys_.push_back(node_key(first[0] + cell[0] + (e & 1), first[1] + cell[1] + (e >> 1 & 1),
                                 first[2] + cell[2] + (e >> 2)));
      const auto lower = [&](int axis) {
        return static_cast<float>(order_.corner(axis) + cell[axis] * static_cast<double>(size_));
      };
      origin_.push_back({lower(0), lower(1), lower(2)});
    }
  }
  node_keys_ = keys_;
  std::sort(node_keys_.begin(), node_keys_.end());
  node_keys_.erase(std::unique(node_keys_.begin(), node_keys_.end()), node_keys_.end());
  SOUPLE_ASSERT(std::is_sorted(node_keys_.begin(), node_keys_.end()), "nodes ascend by key");
  SOUPLE_ASSERT(origin_.size() == count, "one origin per cell");
  corners_.resize(count);
  begin_.assign(node_keys_.size() + 1, 0);
  for (std::size_t c = 0; c < count; ++c) {
    for (std::size_t e = 0; e < 8; ++e) {
      const auto at = std::lower_bound(node_keys_.begin(), node_keys_.end(), keys_[8 * c + e]);
      corners_[c][e] = static_cast<std::uint32_t>(at - node_keys_.begin());
      ++begin_[corners_[c][e] + 1];
    }
  }
  for (std::size_t n = 1; n < begin_.size(); ++n) begin_[n] += begin_[n - 1];
  terms_.resize(8 * count);
  next_.assign(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t c = 0; c < count; ++c)
    for (std::uint32_t e = 0; e < 8; ++e) terms_[next_[corners_[c][e]]++] = 8 * c + e;
  // A node starts with its value of the last step, a new node with 0.
  y_.assign(node_keys_.size(), 0);
  for (std::size_t n = 0; n < last_keys_.size() && n < last_y_.size(); ++n) {
    const auto at = std::lower_bound(node_keys_.begin(), node_keys_.end(), last_keys_[n]);
    if (at != node_keys_.end() && *at == last_keys_[n])
      y_[static_cast<std::size_t>(at - node_keys_.begin())] = last_y_[n];
  }
}

std::array<float, 8> CoarsePressure::weights(std::size_t cell, const Vec4f& position) const {
  const float inverse = 1 / size_;
  // Particles may leave their cell slightly within a step: the weights extrapolate linearly.
  const float x = (position.x - origin_[cell][0]) * inverse, y = (position.y - origin_[cell][1]) * inverse,
              z = (position.z - origin_[cell][2]) * inverse;
  const float a = 1 - x, b = 1 - y, c = 1 - z;
  return {a * b * c, x * b * c, a * y * c, x * y * c, a * b * z, x * b * z, a * y * z, x * y * z};
}

void CoarsePressure::gather(std::span<const Eight> of_cells, std::vector<double>& of_nodes) const {
  of_nodes.resize(y_.size());
  for (std::size_t n = 0; n < y_.size(); ++n) {
    double sum = 0;
    for (std::uint32_t t = begin_[n]; t < begin_[n + 1]; ++t) sum += of_cells[terms_[t] / 8][terms_[t] % 8];
    of_nodes[n] = sum;
  }
}

void CoarsePressure::apply(const std::vector<double>& y, std::vector<double>& result) {
  for (std::size_t c = 0; c < corners_.size(); ++c) {
    Eight at;
    for (std::size_t e = 0; e < 8; ++e) at[e] = y[corners_[c][e]];
    cell_sums_[c] = element(at);
    for (double& value : cell_sums_[c]) value *= stiffness_[c];
  }
  gather(cell_sums_, result);
  for (std::size_t n = 0; n < y.size(); ++n) result[n] += system_.diagonal[n] * y[n];
  add_bodies(y, result);
}

void CoarsePressure::sum_cells(std::span<const Vec4f> positions, std::span<const Sample> samples,
                               float surface, Threads& threads) {
  const std::size_t count = order_.cell_count();
  cell_sums_.resize(count);
  cell_diagonals_.resize(count);
  stiffness_.resize(count);
  threads.each(count, 16, [&](std::size_t c) {
    Eight b{}, diagonal{};
    double w = 0;
    for (std::uint32_t k = order_.cells()[c].begin; k < order_.cells()[c + 1].begin; ++k) {
      const std::uint32_t index = order_.order()[k];
      const Sample& sample = samples[index];
      const std::array<float, 8> n = weights(c, positions[index]);
      const float pushed = sample.c > -surface ? sample.c : 0;
      w += static_cast<double>(positions[index].w);
      for (std::size_t e = 0; e < 8; ++e) {
        b[e] -= static_cast<double>(n[e] * pushed);
        diagonal[e] += static_cast<double>(n[e] * sample.diagonal);
      }
    }
    cell_sums_[c] = b;
    cell_diagonals_[c] = diagonal;
    stiffness_[c] = w / (static_cast<double>(size_) * static_cast<double>(size_));
  });
}

void CoarsePressure::find_system(std::span<const Vec4f> positions, std::span<const Sample> samples,
                                 float surface, Threads& threads) {
  auto& [b, diagonal, preconditioner, r, p, ap] = system_;
  sum_cells(positions, samples, surface, threads);
  gather(cell_sums_, b);
  gather(cell_diagonals_, diagonal);
  for (std::size_t c = 0; c < stiffness_.size(); ++c) cell_diagonals_[c].fill(stiffness_[c] / 3);
  gather(cell_diagonals_, preconditioner);
  for (std::size_t m = 0; m < mover_count_; ++m) {
    const Mover& body = movers_[m];
    for (std::size_t k = 0; k < body.nodes.size(); ++k) {
      const auto& [force, torque] = body.pushes[k];
      preconditioner[body.nodes[k]] +=
          dot(force, force) * body.inverse_mass + dot(torque, body.inverse_inertia * torque);
    }
  }
  for (std::size_t n = 0; n < y_.size(); ++n) {
    diagonal[n] = std::max(diagonal[n], 0.0);
    preconditioner[n] = 1 / (preconditioner[n] + diagonal[n]);
  }
}

// r = b - A y; z = M^-1 r
void CoarsePressure::iterate() {
  constexpr int max_iterations = 30;
  constexpr double tolerance = 0.02;
  auto& [b, diagonal, preconditioner, r, p, ap] = system_;
  apply(y_, ap);
  r.resize(y_.size());
  p.resize(y_.size());
  double rz = 0, bb = 0;
  for (std::size_t n = 0; n < y_.size(); ++n) {
    r[n] = b[n] - ap[n];
    p[n] = preconditioner[n] * r[n];
    rz += r[n] * p[n];
    bb += b[n] * preconditioner[n] * b[n];
  }
  iterations_ = 0;
  while (iterations_ < max_iterations && rz > tolerance * tolerance * bb) {
    apply(p, ap);
    const double curvature = std::inner_product(p.begin(), p.end(), ap.begin(), 0.0);
    // Only rounding makes it negative: the matrix does not feel p, as where many particles are at one place.
    if (curvature <= 0) break;
    const double alpha = rz / curvature;
    double next = 0;
    for (std::size_t n = 0; n < y_.size(); ++n) {
      y_[n] += alpha * p[n];
      r[n] -= alpha * ap[n];
      next += r[n] * preconditioner[n] * r[n];
    }
    for (std::size_t n = 0; n < y_.size(); ++n) p[n] = preconditioner[n] * r[n] + next / rz * p[n];
    rz = next;
    ++iterations_;
  }
}

void CoarsePressure::solve(std::span<const Vec4f> positions, std::span<const Sample> samples, float surface,
                           Threads& threads) {
  constexpr double kept = 0.9;
  find_system(positions, samples, surface, threads);
  for (double& y : y_) y *= kept;
  iterate();
  last_keys_ = node_keys_;
  last_y_ = y_;
}

void CoarsePressure::interpolate(std::span<const Vec4f> positions, std::span<const Sample> samples,
                                 float surface, std::span<float> lambda, Threads& threads) const {
  threads.each(order_.cell_count(), 16, [&](std::size_t c) {
    for (std::uint32_t k = order_.cells()[c].begin; k < order_.cells()[c + 1].begin; ++k) {
      const std::uint32_t index = order_.order()[k];
      const std::array<float, 8> n = weights(c, positions[index]);
      float sum = 0;
      for (std::size_t e = 0; e < 8; ++e) sum += n[e] * static_cast<float>(y_[corners_[c][e]]);
      lambda[index] = samples[index].c > -surface ? sum : 0;
    }
  });
}

}  // namespace souple
