#pragma once

#include "souple/math/bit_cast.h"
#include "souple/math/vec3.h"

#include <cstddef>
#include <cstdint>
#include <span>

/// Numbers as bytes of a given order, independent of the machine's order. Compilers turn these loops into
/// single moves.
namespace souple {

enum class ByteOrder { little, big };

/// Writes the N = sizeof(Unsigned) bytes of `value` to `out`.
template <ByteOrder order, class Unsigned>
void store(std::byte* out, Unsigned value) {
  constexpr std::size_t n = sizeof(Unsigned);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t shift = 8 * (order == ByteOrder::little ? i : n - 1 - i);
    out[i] = static_cast<std::byte>((value >> shift) & 0xff);
  }
}

template <ByteOrder order, class Unsigned>
Unsigned load(const std::byte* in) {
  constexpr std::size_t n = sizeof(Unsigned);
  Unsigned value = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t shift = 8 * (order == ByteOrder::little ? i : n - 1 - i);
    value |= static_cast<Unsigned>(std::to_integer<Unsigned>(in[i]) << shift);
  }
  return value;
}

template <ByteOrder order>
void store_float(std::byte* out, float value) {
  store<order>(out, bit_cast<std::uint32_t>(value));
}

template <ByteOrder order>
float load_float(const std::byte* in) {
  return bit_cast<float>(load<order, std::uint32_t>(in));
}

/// Writes three floats per point; `out` has 12 bytes per point.
template <ByteOrder order>
void store_points(std::byte* out, std::span<const Vec3f> points) {
  for (const Vec3f& p : points) {
    store_float<order>(out, p.x);
    store_float<order>(out + 4, p.y);
    store_float<order>(out + 8, p.z);
    out += 12;
  }
}

template <ByteOrder order>
void load_points(const std::byte* in, std::span<Vec3f> points) {
  for (Vec3f& p : points) {
    p = {load_float<order>(in), load_float<order>(in + 4), load_float<order>(in + 8)};
    in += 12;
  }
}

}  // namespace souple
