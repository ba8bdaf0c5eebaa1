#include "souple/surface/surface_field.h"

#include "souple/math/limits.h"
#include "souple/surface/kernels/find_kernels.h"

#include <algorithm>
#include <cmath>

namespace souple {

using kernels::brick_nodes;
using kernels::brick_side;

namespace {

constexpr std::size_t block_size = 32;  // bricks in one Gathered

/// The nodes of a brick that are next to its neighbor in direction (dx, dy, dz), each -1, 0 or 1.
constexpr std::uint64_t facing(int dx, int dy, int dz) {
  const auto lies = [](int d, int n) { return d == 0 || n == (d > 0 ? brick_side - 1 : 0); };
  std::uint64_t nodes = 0;
  for (int n = 0; n < brick_nodes; ++n)
    if (lies(dx, n % 4) && lies(dy, n / 4 % 4) && lies(dz, n / 16)) nodes |= std::uint64_t{1} << n;
  return nodes;
}

struct Direction {
  std::int32_t x, y, z;
  std::uint64_t facing;
};
constexpr std::array<Direction, 26> directions = [] {
  std::array<Direction, 26> all{};
  std::size_t count = 0;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (dx != 0 || dy != 0 || dz != 0) all[count++] = {dx, dy, dz, facing(dx, dy, dz)};
  return all;
}();

}  // namespace

bool SurfaceField::BrickRange::holds(const Bricks::Coordinates& at) const {
  bool result = true;
  for (std::size_t a = 0; a < 3; ++a) result = result && first[a] <= at[a] && at[a] <= last[a];
  return result;
}

// A brick is evaluated where the kernel of a particle at the surface reaches it, or where a neighboring brick
// is missing. Other bricks that a kernel reaches count as all inside, until an evaluated neighbor has an
// outside node next to them.
void SurfaceField::build(const CellOrder& order, float cell_size, const ParticleKernels& particles,
                         Threads& threads) {
  if (functions_ == nullptr) functions_ = &kernels::find_surface_kernels(instruction_set());
  cell_size_ = static_cast<double>(cell_size);
  particle_kernels_ = particles.kernels().data();
  find_boxes(order, particles, threads);
  add_bricks();
  const std::size_t count = bricks_.size();
  state_.assign(count, State::inside);
  inside_.assign(count, ~std::uint64_t{0});
  list_index_.resize(count);
  values_.resize(count * brick_nodes);
  threads.for_each(count, 1024, [&](std::size_t first, std::size_t last) {
    std::fill(values_.begin() + static_cast<std::ptrdiff_t>(first * brick_nodes),
              values_.begin() + static_cast<std::ptrdiff_t>(last * brick_nodes), 2 * level_);
  });
  list_.clear();
  evaluated_count_ = 0;
  choose_first();
  while (evaluated_count_ < list_.size()) {
    evaluate(order, particles, threads);
    choose_next();
  }
}

void SurfaceField::find_boxes(const CellOrder& order, const ParticleKernels& particles, Threads& threads) {
  const std::size_t count = order.cell_count();
  cell_boxes_.resize(count);
  surface_boxes_.resize(count);
  threads.each(count, 256, [&](std::size_t c) {
    KernelBox all = KernelBox::none(), surface = KernelBox::none();
    for (std::uint32_t i = order.cells()[c].begin; i < order.cells()[c + 1].begin; ++i) {
      all.add(particles.boxes()[i]);
      if (particles.at_surface()[i] != 0) surface.add(particles.boxes()[i]);
    }
    cell_boxes_[c] = all, surface_boxes_[c] = surface;
  });
  furthest_ = {};
  for (std::size_t row = 0; row < order.row_count(); ++row) {
    for (std::uint32_t c = order.rows()[row].begin; c < order.rows()[row + 1].begin; ++c) {
      const std::int32_t at[3] = {order.cells()[c].x, order.rows()[row].y, order.rows()[row].z};
      for (std::size_t a = 0; a < 3; ++a) {
        const double lo = order.corner(static_cast<int>(a)) + at[a] * cell_size_;
        furthest_[a] = std::max({furthest_[a], lo - static_cast<double>(cell_boxes_[c].lo[a]),
                                 static_cast<double>(cell_boxes_[c].hi[a]) - (lo + cell_size_)});
      }
    }
  }
}

SurfaceField::BrickRange SurfaceField::range_of(const KernelBox& box) const {
  const double inverse = 1 / (brick_side * static_cast<double>(cell_));
  // A brick exists where a kernel reaches beyond its first nodes. Then the bricks before it exist too, whose
  // last cells end at these nodes.
  BrickRange range;
  for (std::size_t a = 0; a < 3; ++a) {
    range.first[a] = cell_of(static_cast<double>(box.lo[a]) * inverse);
    range.last[a] = cell_of(static_cast<double>(box.hi[a]) * inverse);
  }
  return range;
}

void SurfaceField::add_bricks() {
  bricks_.clear();
  for (std::size_t c = 0; c < cell_boxes_.size(); ++c) {
    const BrickRange all = range_of(cell_boxes_[c]);
    BrickRange surface{{0, 0, 0}, {-1, -1, -1}};
    if (!surface_boxes_[c].empty()) surface = range_of(surface_boxes_[c]);
    for (std::int32_t z = all.first[2]; z <= all.last[2]; ++z)
      for (std::int32_t y = all.first[1]; y <= all.last[1]; ++y)
        for (std::int32_t x = all.first[0]; x <= all.last[0]; ++x)
          bricks_.add({x, y, z}, surface.holds({x, y, z}));
  }
  bricks_.sort();
}

void SurfaceField::choose_first() {
  for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
    bool chosen = bricks_.marked(b);
    const Bricks::Coordinates at = bricks_.at(b);
    for (std::size_t d = 0; d < directions.size() && !chosen; ++d) {
      const Direction& to = directions[d];
      chosen = bricks_.find({at[0] + to.x, at[1] + to.y, at[2] + to.z}) == Bricks::none;
    }
    if (!chosen) continue;
    state_[b] = State::evaluated;
    list_.push_back(b);
  }
}

void SurfaceField::evaluate(const CellOrder& order, const ParticleKernels& particles, Threads& threads) {
  // The last block may be partly filled: a later round continues it.
  for (std::size_t k = evaluated_count_; k < list_.size(); ++k)
    list_index_[list_[k]] = static_cast<std::uint32_t>(k);
  const std::size_t first_block = evaluated_count_ / block_size;
  const std::size_t blocks = (list_.size() + block_size - 1) / block_size;
  if (gathered_.size() < blocks) gathered_.resize(blocks);
  threads.each(blocks - first_block, 1,
               [&](std::size_t b) { evaluate_block(order, particles, first_block + b); });
}

void SurfaceField::evaluate_block(const CellOrder& order, const ParticleKernels& particles,
                                  std::size_t block) {
  Gathered& gathered = gathered_[block];
  const std::size_t begin = block * block_size, end = std::min(begin + block_size, list_.size());
  if (begin >= evaluated_count_) {
    gathered.kernel.clear();
    gathered.first.assign(1, 0);
  }
  for (std::size_t k = std::max(begin, evaluated_count_); k < end; ++k) {
    const std::uint32_t brick = list_[k];
    const std::size_t before = gathered.kernel.size();
    gather(order, particles, brick, gathered.kernel);
    gathered.first.push_back(static_cast<std::uint32_t>(gathered.kernel.size()));
    float* values = values_.data() + std::size_t{brick} * brick_nodes;
    functions_->brick(particles.kernels().data(), gathered.kernel.data() + before,
                      gathered.kernel.size() - before, origin(brick).data(), cell_, values);
    std::uint64_t inside = 0;
    for (std::size_t n = 0; n < brick_nodes; ++n)
      inside |= values[n] > level_ ? std::uint64_t{1} << n : std::uint64_t{0};
    inside_[brick] = inside;
  }
}

// In the order of cells, then of sorted indices.
void SurfaceField::gather(const CellOrder& order, const ParticleKernels& particles, std::uint32_t brick,
                          std::vector<std::uint32_t>& found) const {
  KernelBox box;
  std::int32_t first[3], last[3];
  const std::array<float, 3> from = origin(brick);
  for (int a = 0; a < 3; ++a) {
    const auto k = static_cast<std::size_t>(a);
    box.lo[a] = from[k];
    box.hi[a] = from[k] + static_cast<float>(brick_side) * cell_;
    const double margin = furthest_[k] + 0.01 * cell_size_;
    const auto cell_at = [&](double x) { return cell_of((x - order.corner(a)) / cell_size_); };
    first[a] = cell_at(static_cast<double>(box.lo[a]) - margin);
    last[a] = cell_at(static_cast<double>(box.hi[a]) + margin);
  }
  const auto cells = order.cells();
  const auto rows = order.rows();
  const auto rows_end = rows.end() - 1;
  auto row = rows.begin();
  for (std::int32_t z = first[2]; z <= last[2]; ++z) {
    row = std::partition_point(row, rows_end,
                               [&](const CellOrder::Row& r) { return r.z != z ? r.z < z : r.y < first[1]; });
    for (; row != rows_end && row->z == z && row->y <= last[1]; ++row) {
      const CellOrder::Cell* const end = cells.data() + (row + 1)->begin;
      auto cell = std::partition_point(cells.data() + row->begin, end,
                                       [&](const CellOrder::Cell& c) { return c.x < first[0]; });
      for (; cell != end && cell->x <= last[0]; ++cell) {
        if (!cell_boxes_[static_cast<std::size_t>(cell - cells.data())].overlaps(box)) continue;
        for (std::uint32_t i = cell->begin; i < (cell + 1)->begin; ++i)
          if (particles.boxes()[i].overlaps(box)) found.push_back(i);
      }
    }
  }
}

// Adds bricks that counted as inside and are next to an outside node.
void SurfaceField::choose_next() {
  const std::size_t end = list_.size();
  for (std::size_t k = evaluated_count_; k < end; ++k) {
    const std::uint64_t outside = ~inside_[list_[k]];
    if (outside == 0) continue;
    const Bricks::Coordinates at = bricks_.at(list_[k]);
    for (const Direction& to : directions) {
      if ((outside & to.facing) == 0) continue;
      const std::uint32_t other = bricks_.find({at[0] + to.x, at[1] + to.y, at[2] + to.z});
      if (other == Bricks::none || state_[other] == State::evaluated) continue;
      state_[other] = State::evaluated;
      list_.push_back(other);
    }
  }
  evaluated_count_ = end;
}

std::span<const std::uint32_t> SurfaceField::kernels_near(std::uint32_t brick) const {
  if (brick == Bricks::none || state_[brick] != State::evaluated) return {};
  const std::size_t k = list_index_[brick] % block_size;
  const Gathered& gathered = gathered_[list_index_[brick] / block_size];
  return {gathered.kernel.data() + gathered.first[k], gathered.first[k + 1] - gathered.first[k]};
}

std::array<float, 3> SurfaceField::origin(std::size_t brick) const {
  const Bricks::Coordinates at = bricks_.at(brick);
  std::array<float, 3> result;
  for (std::size_t a = 0; a < 3; ++a)
    result[a] = static_cast<float>(static_cast<double>(brick_side * at[a]) * static_cast<double>(cell_));
  return result;
}

}  // namespace souple
