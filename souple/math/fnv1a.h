#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace souple {

/// FNV-1a, 64 bits (Fowler, Noll and Vo): for each byte, hash = (hash ^ byte) * 1099511628211. It detects
/// accidental changes, not forgeries. For streams, pass the hash of the earlier bytes as `hash`.
inline constexpr std::uint64_t fnv1a64_start = 14695981039346656037ull;

inline std::uint64_t fnv1a64(std::span<const std::byte> bytes, std::uint64_t hash = fnv1a64_start) {
  for (const std::byte byte : bytes) hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211ull;
  return hash;
}

inline std::uint64_t fnv1a64(std::string_view text, std::uint64_t hash = fnv1a64_start) {
  return fnv1a64(std::as_bytes(std::span(text.data(), text.size())), hash);
}

}  // namespace souple
