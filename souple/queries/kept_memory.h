#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace souple {

// Memory that others may keep after the container that allocated it has given it up.

/// Memory for `bytes` bytes that this caller and everyone who keeps it share.
void* allocate_kept(std::size_t bytes);
void release_kept(void* memory) noexcept;
/// Whether anyone keeps it beside its container.
bool is_kept(const void* memory) noexcept;

template <class T>
struct KeptAllocator {
  using value_type = T;
  KeptAllocator() = default;
  template <class U>
  KeptAllocator(const KeptAllocator<U>&) {}  // NOLINT(google-explicit-constructor)
  T* allocate(std::size_t n) { return static_cast<T*>(allocate_kept(n * sizeof(T))); }
  void deallocate(T* memory, std::size_t) noexcept { release_kept(memory); }
  friend bool operator==(const KeptAllocator&, const KeptAllocator&) { return true; }
};

using KeptPoints = std::vector<Vec3f, KeptAllocator<Vec3f>>;

/// Keeps the memory of a span that World::positions, velocities, normals or angular_velocities returned, also after its object
/// was removed. Null for an empty span.
std::shared_ptr<const void> keep(std::span<const Vec3f> points);

}  // namespace souple
