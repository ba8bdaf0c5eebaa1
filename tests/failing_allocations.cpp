#include "tests/failing_allocations.h"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

// A separate source: g++ 12 warns of mismatched allocation and release where it sees both.

namespace {

constexpr long never = std::numeric_limits<long>::max();
std::atomic<long> allocations{0};
std::atomic<long> first{never}, last{never};  // numbers of the allocations that fail
std::atomic<bool> spare{false}, only_elsewhere{false};
thread_local bool is_home = false;

/// Whether the next allocation fails.
bool fails() {
  if (spare || (only_elsewhere && is_home)) return false;
  const long number = ++allocations;
  return number >= first && number <= last;
}

void* allocate(std::size_t size) {
  return fails() ? nullptr : std::malloc(size == 0 ? 1 : size);
}

}  // namespace

namespace souple::test {

FailingAllocations::FailingAllocations(long n, Which which) {
  is_home = true;
  only_elsewhere = which == Which::one_elsewhere;
  allocations = 0;
  last = which == Which::all_later ? never : n;
  first = n;
}

FailingAllocations::~FailingAllocations() {
  first = last = never;
  only_elsewhere = false;
}

long FailingAllocations::count() const {
  return allocations;
}

SpareMemory::SpareMemory() {
  spare = true;
}

SpareMemory::~SpareMemory() {
  spare = false;
}

}  // namespace souple::test

void* operator new(std::size_t size) {
  if (void* memory = allocate(size)) return memory;
  throw std::bad_alloc();
}
// std::stable_sort calls this form.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  if (!fails())
    if (void* memory = std::aligned_alloc(a, (size + a - 1) / a * a)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) {
  return operator new(size);
}
void* operator new[](std::size_t size, const std::nothrow_t& nothrow) noexcept {
  return operator new(size, nothrow);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
