#pragma once

#include "souple/threads/threads.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>

namespace souple {

/// Calls f(i) for i in [0, n), with work stealing; each i must be worth the cost of an atomic operation. A thread first
/// runs its own part in order, as with Threads::for_each, then takes items of other parts. Parts rarely take equal
/// time, and a core may be unavailable. Results of f must not depend on the calling thread.
template <class Function>
void parallel_for(std::size_t n, Threads& threads, const Function& f) {
  constexpr std::size_t max_parts = 64;
  struct alignas(64) Part {
    std::atomic<std::size_t> next{0};
    std::size_t end = 0;
  };
  std::array<Part, max_parts> part;
  const std::size_t parts = std::min({n, max_parts, static_cast<std::size_t>(std::max(threads.count(), 1))});
  for (std::size_t t = 0; t < parts; ++t) {
    part[t].next.store(n * t / parts, std::memory_order_relaxed);
    part[t].end = n * (t + 1) / parts;
  }
  threads.each(parts, 1, [&](std::size_t t) {
    for (std::size_t k = 0; k < parts; ++k) {
      Part& from = part[(t + k) % parts];
      for (std::size_t i; (i = from.next.fetch_add(1, std::memory_order_relaxed)) < from.end;) f(i);
    }
  });
}

}  // namespace souple
