#pragma once

namespace souple::test {

/// While it exists, allocations of this program fail and operator new throws std::bad_alloc. Which ones: the n-th from
/// now on (from 1), on any thread; that and all later ones; or the n-th on another thread than this.
class FailingAllocations {
 public:
  enum class Which { one, all_later, one_elsewhere };
  FailingAllocations(long n, Which which);
  ~FailingAllocations();
  FailingAllocations(const FailingAllocations&) = delete;
  FailingAllocations& operator=(const FailingAllocations&) = delete;

  /// Number of allocations so far, with the failed ones; with `one_elsewhere` of those on other threads.
  long count() const;
};

/// While it exists within the life of a FailingAllocations, none fails, and none counts.
class SpareMemory {
 public:
  SpareMemory();
  ~SpareMemory();
  SpareMemory(const SpareMemory&) = delete;
  SpareMemory& operator=(const SpareMemory&) = delete;
};

}  // namespace souple::test
