#pragma once

namespace souple::test {

/// While it exists, allocations of this program fail: the n-th from now on (from 1), on whatever thread, or that and
/// all later ones. operator new then throws std::bad_alloc.
class FailingAllocations {
 public:
  enum class Which { one, all_later };
  FailingAllocations(long n, Which which);
  ~FailingAllocations();
  FailingAllocations(const FailingAllocations&) = delete;
  FailingAllocations& operator=(const FailingAllocations&) = delete;

  /// Number of allocations so far, with the failed ones.
  long count() const;
};

}  // namespace souple::test
