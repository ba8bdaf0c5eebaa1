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

void* allocate(std::size_t size) {
  const long number = ++allocations;
  if (number >= first && number <= last) return nullptr;
  return std::malloc(size == 0 ? 1 : size);
}

}  // namespace

namespace souple::test {

FailingAllocations::FailingAllocations(long n, Which which) {
  allocations = 0;
  last = which == Which::one ? n : never;
  first = n;
}

FailingAllocations::~FailingAllocations() {
  first = last = never;
}

long FailingAllocations::count() const {
  return allocations;
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
  const long number = ++allocations;
  const auto a = static_cast<std::size_t>(alignment);
  if (number < first || number > last)
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
