#pragma once

#include <bitset>
#include <cstddef>

namespace souple {

/// Kinds of constraints that objects have many of, in the order of solution.
enum class SetKind : std::size_t {
  distance,
  membrane,
  isometric,
  dihedral,
  rope_bending,
  neo_hookean,
  tet_volume
};
inline constexpr std::size_t set_kind_count = 7;

/// Some of them.
class SetKinds {
 public:
  SetKinds() = default;
  SetKinds(SetKind kind) { bits_.set(static_cast<std::size_t>(kind)); }
  static SetKinds all() {
    SetKinds result;
    result.bits_.set();
    return result;
  }
  bool has(SetKind kind) const { return bits_[static_cast<std::size_t>(kind)]; }
  bool any() const { return bits_.any(); }
  SetKinds& operator|=(const SetKinds& others) {
    bits_ |= others.bits_;
    return *this;
  }
  friend SetKinds operator&(SetKinds a, const SetKinds& b) {
    a.bits_ &= b.bits_;
    return a;
  }
  friend SetKinds operator|(SetKinds a, const SetKinds& b) { return a |= b; }

 private:
  std::bitset<set_kind_count> bits_;
};

}  // namespace souple
