#pragma once

#include <type_traits>

namespace souple {

/// The value whose bytes are those of `from`. (libc++ has std::bit_cast from version 14 on only.)
template <class To, class From>
constexpr To bit_cast(const From& from) {
  static_assert(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> &&
                std::is_trivially_copyable_v<From>);
  return __builtin_bit_cast(To, from);
}

}  // namespace souple
