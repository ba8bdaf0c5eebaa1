#pragma once

#include "souple/math/vec3.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

/// Numbers as bytes of a given order, independent of the machine's order.
namespace souple {

enum class ByteOrder { little, big };

/// Writes the bytes of `value` to `out`.
template <ByteOrder order, class Number>
void store(std::byte* out, Number value) {
  static_assert(std::is_arithmetic_v<Number>);
  std::memcpy(out, &value, sizeof value);
  constexpr bool as_machine = (order == ByteOrder::little) == (std::endian::native == std::endian::little);
  if constexpr (!as_machine) std::reverse(out, out + sizeof value);
}

template <ByteOrder order, class Number>
Number load(const std::byte* in) {
  Number value;
  std::memcpy(&value, in, sizeof value);
  std::byte ordered[sizeof value];  // the bytes of a number in the other order are reversed twice
  store<order>(ordered, value);
  std::memcpy(&value, ordered, sizeof value);
  return value;
}

template <ByteOrder order, class Number>
void append_binary(std::string& out, Number value) {
  std::byte bytes[sizeof value];
  store<order>(bytes, value);
  out.append(reinterpret_cast<const char*>(bytes), sizeof bytes);
}

/// Writes three floats per point; `out` has 12 bytes per point.
template <ByteOrder order>
void store_points(std::byte* out, std::span<const Vec3f> points) {
  for (const Vec3f& p : points) {
    store<order>(out, p.x);
    store<order>(out + 4, p.y);
    store<order>(out + 8, p.z);
    out += 12;
  }
}

template <ByteOrder order>
void load_points(const std::byte* in, std::span<Vec3f> points) {
  for (Vec3f& p : points) {
    p = {load<order, float>(in), load<order, float>(in + 4), load<order, float>(in + 8)};
    in += 12;
  }
}

}  // namespace souple
