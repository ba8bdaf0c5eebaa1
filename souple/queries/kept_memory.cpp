#include "souple/queries/kept_memory.h"

#include <atomic>
#include <limits>
#include <new>

namespace souple {

namespace {

/// Lies before the memory, which stays aligned.
struct alignas(std::max_align_t) Header {
  std::atomic<std::size_t> owners{1};
};

Header* header_of(const void* memory) {
  return const_cast<Header*>(static_cast<const Header*>(memory)) -
         1;  // its count is no part of what is constant
}

}  // namespace

void* allocate_kept(std::size_t bytes) {
  if (bytes > std::numeric_limits<std::size_t>::max() - sizeof(Header)) throw std::bad_alloc();
  return new (::operator new(sizeof(Header) + bytes)) Header + 1;
}

void release_kept(void* memory) noexcept {
  Header* const header = header_of(memory);
  if (header->owners.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  header->~Header();
  ::operator delete(header);
}

bool is_kept(const void* memory) noexcept {
  return header_of(memory)->owners.load(std::memory_order_acquire) > 1;
}

std::shared_ptr<const void> keep(std::span<const Vec3f> points) {
  if (points.data() == nullptr) return nullptr;
  auto* const memory = const_cast<Vec3f*>(points.data());
  header_of(memory)->owners.fetch_add(1, std::memory_order_relaxed);
  return {memory, release_kept};
}

}  // namespace souple
