#pragma once

#include "souple/math/vec3.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace souple {

/// Motion of particles since a search for near pairs. The pairs stay complete until the largest motion exceeds half the
/// margin of the search. Where all of them are compared with each other, motions relative to the mean count: a heap
/// that falls as a whole has not moved.
class LargestMotion {
 public:
  /// Largest length of motion(m), m < count, or of its distance from the mean of all. Chunks have one size and their sums
  /// are added in order: the same bits for any number of threads.
  template <class Motion>
  float from_mean(std::size_t count, const Motion& motion, Threads& threads) {
    const std::size_t chunks = prepare(count);
    for_each_chunk(count, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
      sum_[c] = {};
      for (std::size_t m = begin; m < end; ++m) sum_[c] += Vec3d(motion(m));
    });
    Vec3d sum;
    for (std::size_t c = 0; c < chunks; ++c) sum += sum_[c];
    const Vec3f mean(sum / max(1.0, static_cast<double>(count)));
    return largest(
        count, [&](std::size_t m) { return motion(m) - mean; }, threads);
  }
  template <class Motion>
  float from_origin(std::size_t count, const Motion& motion, Threads& threads) {
    prepare(count);
    return largest(count, motion, threads);
  }

 private:
  static constexpr std::size_t chunk = 1024;

  std::size_t prepare(std::size_t count) {
    const std::size_t chunks = (count + chunk - 1) / chunk;
    sum_.resize(chunks), largest_.resize(chunks);
    return chunks;
  }
  template <class Function>
  static void for_each_chunk(std::size_t count, Threads& threads, const Function& f) {
    threads.each((count + chunk - 1) / chunk, 2,
                 [&](std::size_t c) { f(c, c * chunk, std::min(count, (c + 1) * chunk)); });
  }
  template <class Motion>
  float largest(std::size_t count, const Motion& motion, Threads& threads) {
    for_each_chunk(count, threads, [&](std::size_t c, std::size_t begin, std::size_t end) {
      largest_[c] = 0;
      for (std::size_t m = begin; m < end; ++m) largest_[c] = max(largest_[c], length_squared(motion(m)));
    });
    float result = 0;
    for (const float part : largest_) result = max(result, part);
    return sqrt(result);
  }

  // Per chunk.
  std::vector<Vec3d> sum_;
  std::vector<float> largest_;
};

}  // namespace souple
