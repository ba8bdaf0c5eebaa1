#pragma once

#include <Core/RaCore.hpp>
#include <limits>
#include <type_traits>

namespace Ra {
namespace Core {
namespace Utils {

/// A number, or none (any negative one becomes -1). Compared as an int.
class Index {
 public:
  using IntegerType = int;

  constexpr Index(IntegerType value = -1) : m_idx(value < 0 ? -1 : value) {}

  template <typename Integer, typename = std::enable_if_t<!std::is_same_v<Integer, IntegerType>>>
  explicit constexpr Index(Integer value) : m_idx(in_range(value) ? static_cast<IntegerType>(value) : -1) {
    static_assert(std::is_integral_v<Integer>, "an index is made of an integer");
  }

  static constexpr Index Invalid() { return Index(-1); }
  static constexpr Index Max() { return Index(std::numeric_limits<IntegerType>::max()); }

  constexpr bool isValid() const { return m_idx >= 0; }
  constexpr bool isInvalid() const { return m_idx < 0; }
  constexpr void setInvalid() { m_idx = -1; }
  constexpr IntegerType getValue() const { return m_idx; }
  constexpr void setValue(IntegerType value) { m_idx = value < 0 ? -1 : value; }
  constexpr operator IntegerType() const { return m_idx; }

  constexpr Index& operator++() {
    m_idx = *this == Max() ? -1 : m_idx + 1;
    return *this;
  }
  constexpr Index& operator--() {
    if (isValid()) --m_idx;
    return *this;
  }

 private:
  template <typename Integer>
  static constexpr bool in_range(Integer value) {
    if constexpr (std::is_signed_v<Integer>) {
      if (value < 0) return false;
    }
    using Wide = std::make_unsigned_t<std::common_type_t<Integer, IntegerType>>;
    return static_cast<Wide>(value) <= static_cast<Wide>(std::numeric_limits<IntegerType>::max());
  }

  IntegerType m_idx;
};

}  // namespace Utils
}  // namespace Core
}  // namespace Ra
