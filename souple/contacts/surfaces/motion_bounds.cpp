#include "souple/contacts/surfaces/motion_bounds.h"

#include "souple/broad_phase/spatial_hash.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/surfaces/predicted_paths.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <limits>

namespace souple {
namespace {

constexpr std::size_t moved_grain = 2048;

}  // namespace

void MotionBounds::resize(std::size_t chunks) {
  resize_with_spare(blocks_, chunks);
}

void MotionBounds::add_chunk(std::size_t index, PairChunks& pairs) {
  Chunk& chunk = pairs.chunks()[index];
  auto& blocks = blocks_[index];
  std::array<std::uint32_t, 64> seen;  // cache of blocks that were added, by their last bits
  seen.fill(no_surface);
  chunk.blocks = 0;
  const auto add = [&](std::uint32_t block) {
    if (seen[block % seen.size()] == block) return;
    seen[block % seen.size()] = block;
    for (std::uint32_t k = chunk.blocks; k-- > 0;)
      if (blocks[k] == block) return;
    if (chunk.blocks == max_blocks) {
      chunk.blocks = too_many;
    } else {
      blocks[chunk.blocks++] = block;
    }
  };
  chunk.min_distance_bound = chunk.min_gap_bound = std::numeric_limits<float>::infinity();
  for (std::uint32_t k = chunk.begin; k < chunk.end; ++k) {
    for (const std::uint32_t i : pairs.pair(k).particle)
      if (chunk.blocks != too_many) add(i / static_cast<std::uint32_t>(block_size));
    const float distance = pairs.distance_bound(k);
    chunk.min_distance_bound = min(chunk.min_distance_bound, distance);
    chunk.min_gap_bound = min(chunk.min_gap_bound, distance - (1 + speculative_part) * pairs.thickness(k));
  }
}

void MotionBounds::begin_step(const ElementSurfaces& surfaces, std::span<const std::uint8_t> still) {
  const std::size_t n = surfaces.particle_count(), blocks = (n + block_size - 1) / block_size;
  moved_.resize(n), block_motion_.resize(blocks), block_relative_motion_.resize(blocks);
  block_contact_margin_.resize(blocks), was_moved_.resize(n), block_was_moved_.resize(blocks);
  block_was_still_.swap(block_is_still_);
  block_was_still_.resize(blocks, 0);
  block_is_still_.assign(blocks, 1);
  for (std::size_t a = 0; a < surfaces.size(); ++a)
    if (still[a] == 0 && surfaces[a].begin < surfaces[a].reserved_end)
      std::fill(block_is_still_.data() + surfaces[a].begin / block_size,
                block_is_still_.data() + (surfaces[a].reserved_end - 1) / block_size + 1, std::uint8_t{0});
  for (std::size_t b = 0; b < blocks; ++b) {
    if (block_is_still_[b] == 0 || block_was_still_[b] != 0) continue;
    std::fill(moved_.data() + b * block_size, moved_.data() + std::min(n, (b + 1) * block_size), Vec4f{});
    block_motion_[b] = block_relative_motion_[b] = block_contact_margin_[b] = 0;
  }
}

void MotionBounds::measure(const ElementSurfaces& surfaces, const ParticleView& particles,
                           std::span<const float> contact_margin, Threads& threads) {
  const std::size_t n = surfaces.particle_count(), blocks = (n + block_size - 1) / block_size;
  mean_motion_.assign(surfaces.size(), {});
  for (std::size_t a = 0; a < surfaces.size(); ++a) {
    Vec3d sum;
    double count = 0;
    surfaces.for_each_sample(a, [&](std::uint32_t i) { sum += Vec3d(particles.moved(i)), ++count; });
    if (count > 0) mean_motion_[a] = Vec3f(sum / count);
  }
  threads.each(blocks, moved_grain / block_size, [&](std::size_t b) {
    if (block_is_still_[b] != 0 && !still_have_margins_) return;
    const std::size_t begin = b * block_size, end = std::min(n, (b + 1) * block_size);
    block_contact_margin_[b] = *std::max_element(contact_margin.data() + begin, contact_margin.data() + end);
    if (block_is_still_[b] != 0) return;
    float farthest = 0, max_relative = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f moved = particles.moved(i);
      moved_[i].set_xyz(moved);
      farthest = max(farthest, length_squared(moved));
      const std::uint32_t surface = surfaces.of(static_cast<std::uint32_t>(i));
      if (surface != no_surface)
        max_relative = max(max_relative, length_squared(moved - mean_motion_[surface]));
    }
    block_motion_[b] = sqrt(farthest), block_relative_motion_[b] = sqrt(max_relative);
  });
  for (const std::uint32_t i : remeasured_) was_moved_[i] = block_was_moved_[i / block_size] = 0;
  remeasured_.clear();
  max_motion_ = max_relative_motion_ = max_contact_margin_ = 0;
  for (const float farthest : block_motion_) max_motion_ = max(max_motion_, farthest);
  for (const float farthest : block_relative_motion_)
    max_relative_motion_ = max(max_relative_motion_, farthest);
  for (const float margin : block_contact_margin_) max_contact_margin_ = max(max_contact_margin_, margin);
}

void MotionBounds::measure(const ElementSurfaces& surfaces, const ParticleView& particles,
                           std::span<const std::uint32_t> particles_moved) {
  for (const std::uint32_t i : remeasured_) was_moved_[i] = block_was_moved_[i / block_size] = 0;
  remeasured_.assign(particles_moved.begin(), particles_moved.end());
  for (const std::uint32_t i : particles_moved) {
    was_moved_[i] = block_was_moved_[i / block_size] = 1;
    const Vec3f moved = particles.moved(i);
    moved_[i].set_xyz(moved);
    float &farthest = block_motion_[i / block_size], &max_relative = block_relative_motion_[i / block_size];
    farthest = max(farthest, length(moved));
    if (surfaces.of(i) != no_surface)
      max_relative = max(max_relative, length(moved - mean_motion_[surfaces.of(i)]));
    max_motion_ = max(max_motion_, farthest);
    max_relative_motion_ = max(max_relative_motion_, max_relative);
  }
}

bool MotionBounds::may_have_moved(std::size_t index, const Chunk& chunk) const {
  if (chunk.blocks == too_many) return true;
  const auto& blocks = blocks_[index];
  return std::any_of(blocks.data(), blocks.data() + chunk.blocks,
                     [&](std::uint32_t block) { return block_was_moved_[block] != 0; });
}

float MotionBounds::contact_margin(std::size_t index, const Chunk& chunk) const {
  if (max_contact_margin_ <= 0 || chunk.blocks == too_many) return max_contact_margin_;
  float most = 0;
  for (std::uint32_t k = 0; k < chunk.blocks; ++k) most = max(most, block_contact_margin_[blocks_[index][k]]);
  return most;
}

float MotionBounds::of_pair(const NearPair& pair, bool edges) const {
  const auto squared = [&](std::size_t a, std::size_t b) {
    return length_squared(moved_[pair.particle[a]].xyz() - moved_[pair.particle[b]].xyz());
  };
  const float third = edges ? max(squared(1, 2), squared(1, 3)) : squared(0, 1);
  return sqrt(max(third, max(squared(0, 2), squared(0, 3))));
}

float MotionBounds::of_chunk(std::size_t index, const Chunk& chunk) const {
  constexpr float both = 2.001f;  // both elements move
  if (chunk.blocks == too_many) return both * (chunk.inter_object ? max_motion_ : max_relative_motion_);
  const std::vector<float>& moved = chunk.inter_object ? block_motion_ : block_relative_motion_;
  float farthest = 0;
  for (std::uint32_t k = 0; k < chunk.blocks; ++k) farthest = max(farthest, moved[blocks_[index][k]]);
  return both * farthest;
}

std::size_t MotionBounds::bytes() const {
  return bytes_of(blocks_, moved_, was_moved_);
}

}  // namespace souple
