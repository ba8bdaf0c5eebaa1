#include "souple/contacts/vertex_ball_pairs.h"

#include "souple/broad_phase/spatial_hash.h"
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace souple {
namespace {

constexpr std::uint32_t colors_at_once = 64;  // bits of a word
constexpr std::size_t most_pairs =
    64;  // of a ball with later ones: a surface crushed to a point must not stop the world

}  // namespace

VertexBallPairs::VertexBallPairs(const ContactSurface& surface, const ParticlePairs& joined)
    : begin_(surface.begin), end_(surface.end) {
  for (const Vec3d& x : surface.rest) rest_.push_back(Vec3f(x - surface.rest[0]));
  std::vector<Edge> links;
  for (const auto& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) links.push_back({t[k], t[(k + 1) % 3]});
  find_radii(links);
  std::vector<Edge> own;
  for (const auto& [i, j] : joined.sorted())
    if (i >= begin_ && j < end_) own.push_back({i - begin_, j - begin_});
  links.insert(links.end(), own.begin(), own.end());
  joined_ = ParticlePairs(std::move(own));
  blocks_.resize((count() + block_size - 1) / block_size);
  colors_.assign(count(), 0), place_.assign(count(), {}), margin_.assign(count(), 0);
  has_pair_.assign(count(), 0);
  find_near_at_rest(std::move(links), kernels::find_vertex_ball_kernels(instruction_set()));
}

// The mean length of the sides of all triangles at a vertex: an edge between two triangles counts twice.
void VertexBallPairs::find_radii(std::span<const Edge> sides) {
  std::vector<std::uint32_t> sides_of(count());
  radius_.assign(count(), 0);
  for (const Edge& side : sides)
    for (const std::uint32_t i : side) {
      radius_[i] += length(rest_[side[0]] - rest_[side[1]]);
      ++sides_of[i];
    }
  for (std::size_t i = 0; i < count(); ++i) {
    if (sides_of[i] > 0) radius_[i] *= radius_part / static_cast<float>(sides_of[i]);
    largest_radius_ = max(largest_radius_, radius_[i]);
  }
}

// All that `search` leaves out, except for the links.
void VertexBallPairs::find_near_at_rest(std::vector<Edge> links, const kernels::VertexBallKernels& kernels) {
  for (Edge& link : links)
    if (link[0] > link[1]) std::swap(link[0], link[1]);
  std::sort(links.begin(), links.end());
  for (std::size_t m = 0; m < count(); ++m) set(m, rest_[m], 0);
  margin_.assign(count(), largest_radius_ * (1 / rest_part - 1));
  sort();
  for (std::size_t block = 0; block < block_count(); ++block) gather(block);
  BallCells::Search search;
  for (std::size_t slot = 0; slot < cells_.size(); ++slot)
    for (const std::uint32_t other : cells_.find_near(slot, infinity, kernels, search)) {
      const auto [i, j] = std::minmax({cells_.ball(slot), cells_.ball(other)});
      const float distance = rest_part * length(rest_[i] - rest_[j]);
      if (distance < radius_[i] + radius_[j] && distance > 0 &&
          !std::binary_search(links.begin(), links.end(), Edge{i, j}))
        near_at_rest_.push_back({i, j, distance, 0});
    }
}

void VertexBallPairs::search(std::size_t block, const kernels::VertexBallKernels& kernels) {
  auto& [pairs, cells] = blocks_[block];
  pairs.clear();
  cells.bucket_end = 0;
  const std::size_t end = std::min(cells_.size(), (block + 1) * block_size);
  for (std::size_t slot = block * block_size; slot < end; ++slot) {
    const std::span<const std::uint32_t> found = cells_.find_near(slot, rest_part, kernels, cells);
    for (const std::uint32_t other : found.first(std::min(found.size(), most_pairs))) {
      const auto [i, j] = std::minmax({cells_.ball(slot), cells_.ball(other)});
      if (!joined_.contains(i, j)) pairs.push_back({i, j, radius_[i] + radius_[j], 0});
    }
  }
  if (block == 0) append_near_at_rest(pairs);
}

void VertexBallPairs::append_near_at_rest(std::vector<Pair>& pairs) const {
  for (const Pair& pair : near_at_rest_) {
    const float reach = pair.distance + margin_[pair.i] + margin_[pair.j];
    if (length_squared(place_[pair.i] - place_[pair.j]) < reach * reach) pairs.push_back(pair);
  }
}

// Greedily, in the order of pairs. Where a ball has a pair of each color, the rest of its pairs takes the next 64 ones.
void VertexBallPairs::color_pairs() {
  std::fill(has_pair_.begin(), has_pair_.end(), 0);
  color_begin_.assign(1, 0);
  bool left = true;
  for (std::uint32_t first = 0; left; first += colors_at_once) {
    left = false;
    std::fill(colors_.begin(), colors_.end(), 0);
    for (Block& block : blocks_)
      for (Pair& pair : block.pairs) {
        if (pair.color < first) continue;
        const auto free = static_cast<std::uint32_t>(std::countr_one(colors_[pair.i] | colors_[pair.j]));
        pair.color = first + free;
        left = left || free == colors_at_once;
        if (free == colors_at_once) continue;
        colors_[pair.i] |= std::uint64_t{1} << free, colors_[pair.j] |= std::uint64_t{1} << free;
        has_pair_[pair.i] = has_pair_[pair.j] = 1;
        if (color_begin_.size() < pair.color + 2) color_begin_.resize(pair.color + 2, 0);
        ++color_begin_[pair.color + 1];
      }
  }
}

void VertexBallPairs::end_search() {
  color_pairs();
  for (std::size_t color = 1; color < color_begin_.size(); ++color)
    color_begin_[color] += color_begin_[color - 1];
  next_slot_ = color_begin_;
  columns_.resize(color_begin_.back());
  const kernels::BallPairColumns columns = columns_.columns();
  for (const Block& block : blocks_)
    for (const Pair& pair : block.pairs) {
      const std::size_t slot = next_slot_[pair.color]++;
      columns.first_float[0][slot] = 4 * (begin_ + pair.i);
      columns.first_float[1][slot] = 4 * (begin_ + pair.j);
      columns.distance[slot] = pair.distance;
    }
}

void VertexBallPairs::clear() {
  for (Block& block : blocks_) block.pairs.clear();
  std::fill(has_pair_.begin(), has_pair_.end(), 0);
  color_begin_.assign(1, 0);
}

std::size_t VertexBallPairs::bytes() const {
  std::size_t sum = bytes_of(rest_, radius_, near_at_rest_, joined_.sorted(), blocks_, colors_, has_pair_,
                             color_begin_, next_slot_, place_, margin_) +
                    columns_.bytes() + cells_.bytes();
  for (const Block& block : blocks_) sum += bytes_of(block.pairs, block.cells.near);
  return sum;
}

}  // namespace souple
