#include "souple/solver/coloring.h"

#include "souple/assert.h"
#include "souple/math/disjoint_sets.h"
#include "souple/math/lists.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

// First-fit, then repairs of its long tail of small colors. On regular grids first-fit alone is optimal: it
// uses as many colors as constraints meet in a particle. On an irregular mesh it uses up to half as many
// again, and the last colors hold a few dozen constraints. Each color costs a barrier and a partly filled
// SIMD pack.
//
// Tried and rejected: orders by degree (smallest last, largest first) gain no more than the reversed passes
// below and scatter the particles. Making all sizes equal gains nothing: it saves no barrier.

namespace souple {
namespace {

constexpr std::uint32_t colors_per_round = 64;  // one bit per color
constexpr std::uint32_t min_color_size = 512;   // fills the packs of two threads many times over

/// Assigns colors to constraints; considers at most 64 colors at a time.
class Palette {
 public:
  Palette(std::span<const std::uint32_t> indices, std::size_t arity, std::size_t particle_count)
      : indices_(indices), arity_(arity), color_of_(indices.size() / arity), used_colors_(particle_count) {}

  /// Gives each constraint of `pending` the first color in [first, first + 64) that none of its particles has
  /// yet. Returns the constraints that found no color.
  std::vector<std::uint32_t> first_fit(std::span<const std::uint32_t> pending, std::uint32_t first);
  /// Makes colors fewer and larger. Requires at most 64 colors.
  void improve();

  const std::vector<std::uint32_t>& color_of() const { return color_of_; }

 private:
  using Bits = std::uint64_t;
  static constexpr Bits bit(std::uint32_t color) { return Bits{1} << color; }

  std::span<const std::uint32_t> particles(std::uint32_t i) const {
    return indices_.subspan(i * arity_, arity_);
  }
  Bits used_around(std::uint32_t i) const {
    Bits used = 0;
    for (const std::uint32_t particle : particles(i)) used |= used_colors_[particle];
    return used;
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(size_.size()); }
  void move(std::uint32_t i, std::uint32_t color);
  void list_constraints_of_particles();
  void refit_reversed();
  bool dissolve_smallest();
  bool recolor(std::uint32_t i, Bits allowed);
  bool evict_conflicts(std::uint32_t i, std::uint32_t color, Bits allowed);
  void fill_small();

  std::span<const std::uint32_t> indices_;
  std::size_t arity_;
  std::vector<std::uint32_t> color_of_;
  std::vector<Bits> used_colors_;    // per particle: bit mask of its colors in this round
  std::vector<std::uint32_t> size_;  // per color: its constraints; the last colors of a round may be empty

  Lists<std::uint32_t> constraints_;  // per particle
  struct Move {
    std::uint32_t constraint, from;
  };
  std::vector<Move> log_;                 // moves to undo
  std::vector<std::uint32_t> conflicts_;  // scratch of evict_conflicts
};

std::vector<std::uint32_t> Palette::first_fit(std::span<const std::uint32_t> pending, std::uint32_t first) {
  size_.resize(first);
  for (const std::uint32_t i : pending)
    for (const std::uint32_t particle : particles(i)) used_colors_[particle] = 0;
  std::vector<std::uint32_t> uncolored;
  for (const std::uint32_t i : pending) {
    const Bits used = used_around(i);
    if (~used == 0) {
      uncolored.push_back(i);
      continue;
    }
    const auto color = static_cast<std::uint32_t>(std::countr_one(used));
    for (const std::uint32_t particle : particles(i)) used_colors_[particle] |= bit(color);
    color_of_[i] = first + color;
    if (size_.size() <= first + color) size_.resize(first + color + 1);
    ++size_[first + color];
  }
  return uncolored;
}

void Palette::move(std::uint32_t i, std::uint32_t color) {
  std::uint32_t& from = color_of_[i];
  for (const std::uint32_t particle : particles(i))
    used_colors_[particle] = (used_colors_[particle] & ~bit(from)) | bit(color);
  --size_[from], ++size_[color];
  from = color;
}

void Palette::list_constraints_of_particles() {
  constraints_.fill(used_colors_.size(), [&](const auto& add) {
    for (std::uint32_t i = 0; i < color_of_.size(); ++i)
      for (const std::uint32_t particle : particles(i)) add(particle, i);
  });
}

// Iterated greedy (Culberson 1992): first-fit over the colors of the last fit in reverse order. It never
// takes more colors and often fewer, because the constraints that were hard to color choose first.
void Palette::refit_reversed() {
  std::vector<std::uint32_t> next(count());
  std::uint32_t begin = 0;
  for (std::uint32_t color = count(); color-- > 0; begin += size_[color]) next[color] = begin;
  std::vector<std::uint32_t> order(color_of_.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[next[color_of_[i]]++] = i;
  first_fit(order, 0);
}

// Frees color `color` for constraint i: each constraint of that color that shares a particle with i moves to
// another allowed color. The evicted constraints share no particle with each other, so two of them may take
// the same color.
bool Palette::evict_conflicts(std::uint32_t i, std::uint32_t color, Bits allowed) {
  conflicts_.clear();
  for (const std::uint32_t particle : particles(i)) {
    if (!(used_colors_[particle] & bit(color))) continue;
    const std::uint32_t* k = constraints_[particle].data();
    while (color_of_[*k] != color) ++k;
    if ((allowed & ~used_around(*k)) == 0) return false;
    conflicts_.push_back(*k);
  }
  for (const std::uint32_t conflict : conflicts_) {
    if (color_of_[conflict] != color) continue;  // it shares two particles with i and has moved already
    log_.push_back({conflict, color});
    move(conflict, static_cast<std::uint32_t>(std::countr_zero(allowed & ~used_around(conflict))));
  }
  return true;
}

// Moves constraint i to a color of `allowed`; evicts conflicting constraints if necessary.
bool Palette::recolor(std::uint32_t i, Bits allowed) {
  Bits open = allowed & ~used_around(i);
  for (std::uint32_t color = 0; open == 0 && color < count(); ++color)
    if ((allowed & bit(color)) && evict_conflicts(i, color, allowed)) open = bit(color);
  if (open == 0) return false;
  log_.push_back({i, color_of_[i]});
  move(i, static_cast<std::uint32_t>(std::countr_zero(open)));
  return true;
}

// Distributes the constraints of the smallest color among the other colors: all of them or none.
bool Palette::dissolve_smallest() {
  const auto smallest =
      static_cast<std::uint32_t>(std::min_element(size_.begin(), size_.end()) - size_.begin());
  const std::uint32_t last = count() - 1;
  const Bits allowed = (bit(last) | (bit(last) - 1)) & ~bit(smallest);
  log_.clear();
  for (std::uint32_t i = 0; i < color_of_.size() && size_[smallest] > 0; ++i) {
    if (color_of_[i] != smallest || recolor(i, allowed)) continue;
    for (auto undo = log_.rbegin(); undo != log_.rend(); ++undo) move(undo->constraint, undo->from);
    return false;
  }
  for (std::uint32_t i = 0; smallest != last && i < color_of_.size(); ++i)
    if (color_of_[i] == last) move(i, smallest);
  size_.pop_back();
  return true;
}

// Fills small colors with constraints from colors above the mean size.
void Palette::fill_small() {
  const auto mean = static_cast<std::uint32_t>(color_of_.size() / count());
  const std::uint32_t goal = std::min(min_color_size, mean / 2);
  Bits small = 0;
  for (std::uint32_t color = 0; color < count(); ++color)
    if (size_[color] < goal) small |= bit(color);
  for (std::uint32_t i = 0; small != 0 && i < color_of_.size(); ++i) {
    const Bits open = small & ~used_around(i);
    if (open == 0 || size_[color_of_[i]] <= mean) continue;
    const auto color = static_cast<std::uint32_t>(std::countr_zero(open));
    move(i, color);
    if (size_[color] >= goal) small &= ~bit(color);
  }
}

void Palette::improve() {
  if (color_of_.empty()) return;
  list_constraints_of_particles();
  std::size_t min_colors = 0;
  for (std::size_t particle = 0; particle < used_colors_.size(); ++particle)
    min_colors = std::max(min_colors, constraints_[particle].size());
  constexpr int passes = 4;  // more passes rarely save another color
  for (int pass = 0; count() > min_colors; ++pass) {
    while (count() > min_colors && dissolve_smallest()) {
    }
    if (pass == passes) break;
    if (count() > min_colors) refit_reversed();
  }
  fill_small();
}

/// Constraints that are connected by particles. Each piece is colored by itself: what is not connected to it, far objects
/// among it, does not change its order of solution.
class Pieces {
 public:
  Pieces(std::span<const std::uint32_t> indices, std::size_t arity, std::size_t particle_count)
      : constraints_(indices.size() / arity) {
    DisjointSets connected(particle_count);
    for (std::size_t i = 0; i < constraints_.size(); ++i)
      for (std::size_t k = 1; k < arity; ++k) connected.join(indices[i * arity], indices[i * arity + k]);
    std::vector<std::uint32_t> piece_at(particle_count, none), piece_of(constraints_.size());
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      std::uint32_t& piece = piece_at[connected.root(indices[i * arity])];
      if (piece == none) piece = static_cast<std::uint32_t>(end_.size()), end_.push_back(0);
      piece_of[i] = piece;
      ++end_[piece];
    }
    std::uint32_t begin = 0;
    for (std::uint32_t& end : end_) begin += std::exchange(end, begin);
    for (std::uint32_t i = 0; i < constraints_.size(); ++i) constraints_[end_[piece_of[i]]++] = i;
  }
  std::size_t count() const { return end_.size(); }
  std::span<const std::uint32_t> constraints(std::size_t piece) const {
    const std::size_t begin = piece == 0 ? 0 : end_[piece - 1];
    return std::span(constraints_).subspan(begin, end_[piece] - begin);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> constraints_;  // piece after piece, each in order
  std::vector<std::uint32_t> end_;          // per piece
};

/// Numbers particles in the order in which they occur. `local`: work space, per particle. Returns how many there are.
std::size_t number(std::span<std::uint32_t> particles, std::vector<std::uint32_t>& local) {
  std::size_t count = 0;
  std::vector<std::uint32_t> seen;  // by number
  for (std::uint32_t& particle : particles) {
    const std::uint32_t known = local[particle];
    if (known >= count || seen[known] != particle) {
      local[particle] = static_cast<std::uint32_t>(count++);
      seen.push_back(particle);
    }
    particle = local[particle];
  }
  return count;
}

/// Returns the color of each constraint.
std::vector<std::uint32_t> color_piece(std::span<const std::uint32_t> indices, std::size_t arity,
                                       std::size_t particle_count) {
  Palette palette(indices, arity, particle_count);
  std::vector<std::uint32_t> pending(indices.size() / arity);
  std::iota(pending.begin(), pending.end(), 0u);
  pending = palette.first_fit(pending, 0);
  if (pending.empty()) palette.improve();
  for (std::uint32_t first = colors_per_round; !pending.empty(); first += colors_per_round)
    pending = palette.first_fit(pending, first);
  return palette.color_of();
}

std::vector<std::uint32_t> reordered(std::span<const std::uint32_t> indices, std::size_t arity,
                                     std::span<const std::uint32_t> order) {
  std::vector<std::uint32_t> result;
  result.reserve(indices.size());
  for (const std::uint32_t i : order)
    for (const std::uint32_t particle : indices.subspan(i * arity, arity)) result.push_back(particle);
  return result;
}

}  // namespace

Coloring color_constraints(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count) {
  const auto width = static_cast<std::size_t>(arity);
  const Pieces pieces(indices, width, particle_count);
  std::vector<std::uint32_t> color_of(indices.size() / width), local(particle_count), own;
  for (std::size_t p = 0; p < pieces.count(); ++p) {
    const std::span<const std::uint32_t> constraints = pieces.constraints(p);
    own.clear();
    for (const std::uint32_t i : constraints)
      for (const std::uint32_t particle : indices.subspan(i * width, width)) own.push_back(particle);
    const std::size_t count = number(own, local);
    const std::vector<std::uint32_t> colors = color_piece(own, width, count);
    for (std::size_t k = 0; k < constraints.size(); ++k) color_of[constraints[k]] = colors[k];
  }
  Coloring result = sorted_by_color(indices, arity, particle_count, color_of);
  SOUPLE_ASSERT(are_independent(reordered(indices, width, result.order), arity, result.color_begin),
                "constraints of one color share no particle");
  return result;
}

bool are_independent(std::span<const std::uint32_t> indices, int arity,
                     std::span<const std::uint32_t> color_begin) {
  const auto width = static_cast<std::size_t>(arity);
  std::vector<std::size_t> last;  // per particle: its last constraint, counted from 1
  for (std::size_t c = 0; c + 1 < color_begin.size(); ++c)
    for (std::size_t i = color_begin[c]; i < color_begin[c + 1]; ++i)
      for (const std::uint32_t particle : indices.subspan(i * width, width)) {
        if (particle >= last.size()) last.resize(particle + std::size_t{1});
        if (last[particle] > color_begin[c] && last[particle] != i + 1) return false;
        last[particle] = i + 1;
      }
  return true;
}

// Two stable counting sorts.
Coloring sorted_by_color(std::span<const std::uint32_t> indices, int arity, std::size_t particle_count,
                         std::span<const std::uint32_t> color_of) {
  const auto width = static_cast<std::size_t>(arity);
  const auto lowest = [&](std::uint32_t i) {
    const auto own = indices.subspan(i * width, width);
    return *std::min_element(own.begin(), own.end());
  };
  const std::size_t count = color_of.size();
  std::vector<std::uint32_t> next(particle_count + 1), by_particle(count), size;
  for (std::uint32_t i = 0; i < count; ++i) ++next[lowest(i) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::uint32_t i = 0; i < count; ++i) by_particle[next[lowest(i)]++] = i;

  for (const std::uint32_t color : color_of) {
    if (color >= size.size()) size.resize(color + 1);
    ++size[color];
  }
  Coloring result;
  result.order.resize(count);
  next.assign(size.size(), 0);
  std::uint32_t begin = 0;
  for (std::size_t color = 0; color < size.size(); ++color) {
    if (size[color] > 0) result.color_begin.push_back(begin);
    next[color] = begin;
    begin += size[color];
  }
  result.color_begin.push_back(begin);
  for (const std::uint32_t i : by_particle) result.order[next[color_of[i]]++] = i;
  SOUPLE_ASSERT(begin == count, "every constraint has one color");
  return result;
}

}  // namespace souple
