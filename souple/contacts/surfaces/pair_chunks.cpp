#include "souple/contacts/surfaces/pair_chunks.h"

#include "souple/assert.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {

void PairChunks::List::resize(std::size_t size) {
  particle.resize(size), thickness.resize(size), distance_bound.resize(size);
}

void PairChunks::List::add(const NearPair& pair, float pair_thickness, float distance) {
  particle[count] = pair, thickness[count] = pair_thickness, distance_bound[count] = distance;
  ++count;
}

std::size_t PairChunks::List::bytes() const {
  return bytes_of(particle, thickness, distance_bound);
}

void PairChunks::clear() {
  particle_.clear(), thickness_.clear(), distance_bound_.clear(), is_edges_.clear();
  chunks_.clear();
}

void PairChunks::clear(std::size_t particles) {
  clear();
  replace_none();
  valid_from_.resize(particles, 0);
}

void PairChunks::replace_none() {
  for (const std::uint32_t i : replaced_) valid_from_[i] = 0;
  replaced_.clear();
}

void PairChunks::append(std::span<Batch> batches, List Batch::*list, bool edges, bool inter_object,
                        Threads& threads) {
  const std::size_t begin = size();
  std::size_t sum = begin;
  for (Batch& batch : batches) {
    (batch.*list).offset = sum;
    sum += (batch.*list).count;
  }
  resize_with_spare(particle_, sum);
  resize_with_spare(is_edges_, sum);
  for (std::vector<float>* column : {&thickness_, &distance_bound_}) resize_with_spare(*column, sum);
  threads.each(batches.size(), 1, [&](std::size_t b) {
    const List& from = batches[b].*list;
    std::copy_n(from.particle.data(), from.count, particle_.data() + from.offset);
    std::copy_n(from.thickness.data(), from.count, thickness_.data() + from.offset);
    std::copy_n(from.distance_bound.data(), from.count, distance_bound_.data() + from.offset);
    std::fill_n(is_edges_.data() + from.offset, from.count, edges ? 1 : 0);
  });
  if (chunks_.capacity() == 0) chunks_.reserve(64);
  for (std::size_t next = begin; next < sum; next += chunk_size) {
    Chunk chunk;
    chunk.begin = static_cast<std::uint32_t>(next);
    chunk.end = static_cast<std::uint32_t>(std::min(sum, next + chunk_size));
    chunk.edges = edges, chunk.inter_object = inter_object;
    SOUPLE_ASSERT(chunk.begin < chunk.end, "a chunk has pairs");
    chunks_.push_back(chunk);
  }
}

std::span<const std::uint32_t> PairChunks::drop_replaced() {
  if (2 * size() <= 3 * lasting_) return {};
  std::size_t replaced = 0;
  while (replaced < size() && is_replaced(replaced)) ++replaced;
  if (replaced == size()) return {};  // an index of 0 would mean that all pairs are new
  kept_.clear();
  std::size_t chunk_count = 0;
  for (Chunk chunk : chunks_) {
    const auto begin = static_cast<std::uint32_t>(kept_.size());
    for (std::uint32_t k = chunk.begin; k < chunk.end; ++k) {
      if (is_replaced(k)) continue;
      const std::size_t to = kept_.size();
      particle_[to] = particle_[k], is_edges_[to] = is_edges_[k];
      thickness_[to] = thickness_[k], distance_bound_[to] = distance_bound_[k];
      kept_.push_back(k);
    }
    chunk.begin = begin, chunk.end = static_cast<std::uint32_t>(kept_.size());
    if (chunk.begin < chunk.end) chunks_[chunk_count++] = chunk;
  }
  chunks_.resize(chunk_count);
  particle_.resize(kept_.size()), is_edges_.resize(kept_.size());
  thickness_.resize(kept_.size()), distance_bound_.resize(kept_.size());
  replace_none();
  lasting_ = size();
  return kept_;
}

kernels::ElementPairColumns PairChunks::columns() {
  return {particle_.empty() ? nullptr : &particle_[0].particle, thickness_.data(), distance_bound_.data()};
}

std::size_t PairChunks::bytes() const {
  return bytes_of(particle_, thickness_, distance_bound_, is_edges_, valid_from_, chunks_);
}

}  // namespace souple
